/* The work of every peer, as in `benches/drive.rs` and `benches/peers.py`: a disc in the classic Maze4,
 * at 20 Hz, free between walls or pushed against one, with an impulse of at most 2 Ns a step. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define DT 0.05
#define RADIUS 0.3
#define MASS 5.0
#define SPEED 1.4
#define START 3.5
#define PI 3.14159265358979323846

static const char *const ROWS[] = {"########", "#..#..G#", "##..#..#", "##.#..##",
                                   "#......#", "##.#...#", "#....#.#", "########"};
enum { SIZE = 8 };

/* PROGRAM PUSHING STEPS */
static int is_pushing(char **words) { return atoi(words[1]); }
static long steps(char **words) { return atol(words[2]); }

static double wanted_speed(int pushing, long step) {
    return pushing || step / 20 % 2 == 0 ? SPEED : -SPEED;
}

static double limited(double impulse) {
    return impulse > 2.0 ? 2.0 : impulse < -2.0 ? -2.0 : impulse;
}

static void report(clock_t begin, long steps, double x) {
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    printf("{\"microseconds\": %.4f, \"x\": %.3f}\n", seconds / steps * 1e6, x);
}
