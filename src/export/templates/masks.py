def matches(condition, percept):
    """Returns True if a condition matches a percept: both are strings, and # matches 0 and 1."""
    return all(wanted in ("#", bit) for wanted, bit in zip(condition, percept))
