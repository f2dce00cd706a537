/* A step of Chipmunk, driven from C. */
#include <chipmunk/chipmunk.h>

#include "drive.h"

int main(int count, char **words) {
    if (count != 3) return 2;
    cpSpace *space = cpSpaceNew();
    for (int row = 0; row < SIZE; row++)
        for (int col = 0; col < SIZE; col++)
            if (ROWS[row][col] == '#') {
                cpBB cell = cpBBNew(col, SIZE - row - 1, col + 1, SIZE - row);
                cpSpaceAddShape(space, cpBoxShapeNew2(cpSpaceGetStaticBody(space), cell, 0));
            }
    cpFloat moment = cpMomentForCircle(MASS, 0, RADIUS, cpvzero);
    cpBody *robot = cpSpaceAddBody(space, cpBodyNew(MASS, moment));
    cpBodySetPosition(robot, cpv(START, START));
    cpSpaceAddShape(space, cpCircleShapeNew(robot, RADIUS, cpvzero));
    clock_t begin = clock();
    for (long step = 0; step < steps(words); step++) {
        double missing = wanted_speed(is_pushing(words), step) - cpBodyGetVelocity(robot).x;
        cpVect impulse = cpv(limited(MASS * missing), 0);
        cpBodyApplyImpulseAtWorldPoint(robot, impulse, cpBodyGetPosition(robot));
        cpSpaceStep(space, DT);
    }
    report(begin, steps(words), cpBodyGetPosition(robot).x);
}
