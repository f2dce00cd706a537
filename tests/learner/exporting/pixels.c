/* An independent kinematic simulation: a disc drives among the pixels of a map as an exported policy decides.
 * Prints the cells that it comes to, then the number of times that it touched something. */
#include "policy.h"
#include "pixels.h" /* HEIGHT, WIDTH, PIXEL_M, RADIUS_M, and the rows of `pixels` from the lower edge */
#include <stdio.h>

/* Cosine and sine of a degree. */
#define COSINE 0.99984769515639124
#define SINE 0.017452406437283512

static int is_solid(double x, double y)
{
    const int column = (int)(x / PIXEL_M);
    const int row = (int)(y / PIXEL_M);
    return x < 0.0 || y < 0.0 || column >= WIDTH || row >= HEIGHT || pixels[row][column] == '#';
}

/* Returns 1 if a disc has a point in a solid pixel. */
static int touches(double x, double y)
{
    double east, north;
    for (north = -RADIUS_M; north <= RADIUS_M; north += 0.005) {
        for (east = -RADIUS_M; east <= RADIUS_M; east += 0.005) {
            if (east * east + north * north < RADIUS_M * RADIUS_M && is_solid(x + east, y + north)) {
                return 1;
            }
        }
    }
    return 0;
}

static double range(double x, double y, double cosine, double sine)
{
    double far = 0.0;
    while (far < 3.5 && !is_solid(x + far * cosine, y + far * sine)) {
        far += 0.005;
    }
    return far < 3.5 ? far : 1.0e9;
}

/* Returns the action after a scan in all directions. */
static int decided(double x, double y)
{
    static struct xcscr_scan scan;
    xcscr_word percept[XCSCR_PERCEPT_BYTES];
    double cosine = 1.0, sine = 0.0;
    int beam;
    xcscr_scan_begin(&scan, x, y, 1.0, 0.0);
    for (beam = 0; beam < 360; beam++) {
        const double next = cosine * COSINE - sine * SINE;
        xcscr_scan_add(&scan, cosine, sine, range(x, y, cosine, sine));
        sine = sine * COSINE + cosine * SINE;
        cosine = next;
    }
    xcscr_scan_percept(&scan, percept);
    return xcscr_decide(percept);
}

int main(void)
{
    static const int steps[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    uint16_t column = XCSCR_START_COLUMN, row = XCSCR_START_ROW;
    double x, y;
    int step, part, contacts = 0;
    xcscr_pose_of_cell(column, row, &x, &y);
    for (step = 0; step < 100 && !xcscr_is_goal(column, row); step++) {
        const int action = decided(x, y);
        if (action == XCSCR_NO_ACTION) {
            break;
        }
        for (part = 0; part < 100; part++) {
            x += 0.01 * XCSCR_CELL_SIZE_M * steps[action][0];
            y += 0.01 * XCSCR_CELL_SIZE_M * steps[action][1];
            contacts += touches(x, y);
        }
        xcscr_cell_from_pose(x, y, &column, &row);
        xcscr_pose_of_cell(column, row, &x, &y);
        printf("%d %d\n", column, row);
    }
    printf("%d\n", contacts);
    return 0;
}
