/* A step of MuJoCo, driven from C: the disc is a cylinder on two slides and a hinge. */
#include <mujoco/mujoco.h>
#include <string.h>

#include "drive.h"

static char model_xml[16384];

static void add(const char *text) { strncat(model_xml, text, sizeof model_xml - strlen(model_xml) - 1); }

static const char *model(void) {
    char line[256];
    snprintf(line, sizeof line, "<mujoco><option timestep='%g' gravity='0 0 0'/><worldbody>", DT);
    add(line);
    for (int row = 0; row < SIZE; row++)
        for (int col = 0; col < SIZE; col++)
            if (ROWS[row][col] == '#') {
                snprintf(line, sizeof line, "<geom type='box' size='.5 .5 .5' pos='%g %g 0'/>",
                         col + 0.5, SIZE - row - 0.5);
                add(line);
            }
    snprintf(line, sizeof line, "<body pos='%g %g 0'><joint type='slide' axis='1 0 0'/>"
             "<joint type='slide' axis='0 1 0'/><joint axis='0 0 1'/>", START, START);
    add(line);
    snprintf(line, sizeof line, "<geom type='cylinder' size='%g .2' mass='%g'/>", RADIUS, MASS);
    add(line);
    add("</body></worldbody></mujoco>");
    return model_xml;
}

int main(int count, char **words) {
    if (count != 3) return 2;
    char fault[512], path[] = "/maze.xml";
    mjVFS *files = malloc(sizeof *files);
    mj_defaultVFS(files);
    const char *xml = model();
    mj_makeEmptyFileVFS(files, path, (int)strlen(xml));
    memcpy(files->filedata[0], xml, strlen(xml));
    mjModel *maze = mj_loadXML(path, files, fault, sizeof fault);
    if (!maze) return fprintf(stderr, "%s\n", fault), 1;
    mjData *state = mj_makeData(maze);
    clock_t begin = clock();
    for (long step = 0; step < steps(words); step++) {
        double missing = wanted_speed(is_pushing(words), step) - state->qvel[0];
        state->qfrc_applied[0] = limited(MASS * missing) / DT;
        mj_step(maze, state);
    }
    report(begin, steps(words), START + state->qpos[0]);
}
