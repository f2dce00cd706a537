/* Answers questions about an exported policy. A line has a letter and four hexadecimal numbers, the bits of
 * doubles where they are lengths or cosines:
 *     d PERCEPT               the action, -1 for none
 *     c X Y                   the cell of a point
 *     p COLUMN ROW            the middle of a cell
 *     m COLUMN ROW            the percept in a cell of the map in the first argument, in a maze
 *     w COLUMN ROW WALLS      the percept in a cell of a robot that sees these walls
 *     x X Y                   the percept of a point in a world from a map
 *     o COLUMN ROW WALLS      the open actions as bits, in a world from a map
 */
#include "policy.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#if defined(XCSCR_CLEAR_RADIUS_M)
#define IS_FROM_MAP
#else
static uint8_t look_up(void *user, uint16_t column, uint16_t row)
{
    const char letter = ((const char *)user)[row * XCSCR_COLUMNS + column];
    return letter == '#' ? XCSCR_CELL_WALL : letter == 'G' ? XCSCR_CELL_GOAL : XCSCR_CELL_FREE;
}
#endif

static void show(const xcscr_word *percept)
{
    int bit;
    for (bit = 0; bit < XCSCR_WORDS * XCSCR_WORD_BITS; bit++) {
        putchar('0' + (percept[bit / XCSCR_WORD_BITS] >> (bit % XCSCR_WORD_BITS) & 1));
    }
    putchar('\n');
}

static double real(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

int main(int count, char **arguments)
{
    static xcscr_word percept[XCSCR_WORDS];
    char command;
    uint64_t n[4];
    uint16_t column;
    uint16_t row;
    double x;
    double y;
    int word;
    if (count != 2 || !arguments[1]) {
        return 1;
    }
    while (scanf(" %c %" SCNx64 " %" SCNx64 " %" SCNx64 " %" SCNx64, &command, n, n + 1, n + 2, n + 3) == 5) {
        switch (command) {
        case 'c':
            if (xcscr_cell_from_pose(real(n[0]), real(n[1]), &column, &row)) {
                printf("%u %u\n", (unsigned)column, (unsigned)row);
            } else {
                puts("outside");
            }
            break;
        case 'p':
            xcscr_pose_of_cell((uint16_t)n[0], (uint16_t)n[1], &x, &y);
            printf("%016" PRIx64 " %016" PRIx64 "\n", bits(x), bits(y));
            break;
#if defined(IS_FROM_MAP)
        case 'x':
            if (xcscr_percept(real(n[0]), real(n[1]), percept)) {
                show(percept);
            } else {
                puts("outside");
            }
            break;
        case 'o':
            printf("%u\n", (unsigned)xcscr_open_actions((uint8_t)n[2], (uint16_t)n[0], (uint16_t)n[1]));
            break;
#else
        case 'm':
            xcscr_percept_from_map((uint16_t)n[0], (uint16_t)n[1], look_up, arguments[1], percept);
            show(percept);
            break;
#endif
#if defined(IS_FROM_MAP) || !XCSCR_SHOWS_GOALS
        case 'w':
            xcscr_percept_from_walls((uint8_t)n[2], (uint16_t)n[0], (uint16_t)n[1], percept);
            show(percept);
            break;
#endif
        case 'd':
            for (word = 0; word < XCSCR_WORDS; word++) {
                percept[word] = (xcscr_word)(n[0] >> word * XCSCR_WORD_BITS);
            }
            printf("%d\n", xcscr_decide(percept));
            break;
        default:
            return 1;
        }
    }
    return 0;
}
