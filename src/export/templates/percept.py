def percept_of(bits):
    """A percept in the form that the policy takes: a string of 0 and 1."""
    return "".join(str(bit) for bit in bits)
