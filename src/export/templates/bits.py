def in_binary(number, bits):
    """A number as so many bits, the highest first."""
    return [number >> bit & 1 for bit in reversed(range(bits))]


def as_percept(ring, column, row):
    """A percept in the form that the policy takes: the bits of the cells around, of column and row."""
    return percept_of(ring + in_binary(column, COLUMN_BITS) + in_binary(row, ROW_BITS))
