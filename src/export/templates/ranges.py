def number(percept, first, bits):
    """The number that some bits of a percept encode, the highest first."""
    return int(percept[first : first + bits], 2)


def matches(condition, percept):
    """Returns True if a condition matches a percept: a string in which # matches 0 and 1, then the least and
    the greatest column and row."""
    bits, column, row = condition
    return (
        all(wanted in ("#", bit) for wanted, bit in zip(bits, percept))
        and column[0] <= number(percept, RING_BITS, COLUMN_BITS) <= column[1]
        and row[0] <= number(percept, RING_BITS + COLUMN_BITS, ROW_BITS) <= row[1]
    )
