"""Answers the questions of `driver.c`."""

import struct
import sys

import policy

cells = sys.argv[1]
states = {"#": policy.WALL, "G": policy.GOAL}


def look_up(column, row):
    return states.get(cells[row * policy.COLUMNS + column], policy.FREE)


def show(percept):
    print("".join(str(percept >> at & 1) for at in range(16)) if isinstance(percept, int) else percept)


def real(number):
    return struct.unpack("<d", struct.pack("<Q", number))[0]


for line in sys.stdin:
    command, *numbers = line.split()
    n = [int(number, 16) for number in numbers]
    x, y = map(real, n[:2])
    if command == "c":
        cell = policy.cell_from_pose(x, y)
        print("outside" if cell is None else "{} {}".format(*cell))
    elif command == "p":
        middle = policy.pose_of_cell(n[0], n[1])
        print(*("{:016x}".format(*struct.unpack("<Q", struct.pack("<d", at))) for at in middle))
    elif command == "m":
        show(policy.percept_from_map(n[0], n[1], look_up))
    elif command == "w":
        show(policy.percept_from_walls(n[2], n[0], n[1]))
    elif command == "o":
        print(sum(1 << at for at in policy.open_actions(n[2], n[0], n[1])))
    elif command == "x":
        try:
            show(policy.percept(x, y))
        except ValueError:
            print("outside")
    else:
        action = policy.decide("".join(str(n[0] >> at & 1) for at in range(len(policy.BITS))))
        print(-1 if action is None else action)
