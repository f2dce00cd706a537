def matches(condition, context):
    """Returns True if a condition matches a context. Each part of a condition is a pair: the least and the
    greatest coordinate, or a mask of the demanded bits and their values."""
    for part, (first, second) in condition.items():
        value = context[part]
        if part in ("x", "y"):
            fits = first <= value <= second
        else:
            fits = value & first == second
        if not fits:
            return False
    return True


def percept_of(bits):
    """A percept in the form that the tracker takes: a number of the first sixteen bits, the first one lowest."""
    return sum(bit << at for at, bit in enumerate(bits[:16]))
