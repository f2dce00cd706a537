def ring(passes, column, row):
    """The bits that the rays show, one ray after the other."""
    result = []
    for along, across, bits, codes in RAYS:
        east = north = free = 0
        while free < len(codes) - 1:
            step = across if free % 3 == 1 else along
            if not passes((east, north), step):
                break
            east, north, free = east + step[0], north + step[1], free + 1
        result += in_binary(codes[free], bits)
    return result
