/* A navigator in C, for benchnav: each agent goes where its rays are free, as near to the way
 * to its goal as they allow. It needs nothing but the C library; docs/isolation.md describes
 * the frames that it reads from its standard input and writes to its standard output.
 * Numbers are little-endian, as on every machine that this is likely to run on. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double SIDE = 0.35;   /* [rad] a direction must be free so far to both sides */
static const double AHEAD = 0.8;   /* [s] in which what approaches comes nearer */
static const double NEAR = 1.2;    /* [m] a direction is free that is free so far */
static const double TURNING = 0.3; /* what turning away from the heading costs, per radian */

struct head { char kind[8]; uint64_t fields, bytes; };
struct field { char name[24]; char type; uint8_t axes, zero[6]; uint64_t shape[4]; };

static char *body; /* of the frame that was read last */
static struct head top;

static int read_frame(void) {
    if (fread(&top, sizeof top, 1, stdin) != 1) return 0;
    free(body);
    body = malloc(top.bytes + 1);
    return body && fread(body, 1, top.bytes, stdin) == top.bytes;
}

static uint64_t size_of(const struct field *f) {
    uint64_t items = f->type == 'd' || f->type == 'q' ? 8 : 1;
    for (int k = 0; k < f->axes; k++) items *= f->shape[k];
    return (items + 7) / 8 * 8;
}

/* The data of a field of the frame, and with `about` its shape; NULL where it has none. */
static const void *get(const char *name, const struct field **about) {
    char *at = body;
    for (uint64_t k = 0; k < top.fields; k++) {
        const struct field *f = (const struct field *)at;
        if (strncmp(f->name, name, sizeof f->name) == 0) {
            if (about) *about = f;
            return at + sizeof *f;
        }
        at += sizeof *f + size_of(f);
    }
    return NULL;
}

static void answer(const char *kind, const struct field *f, const void *data, uint64_t bytes) {
    struct head out = {{0}, f ? 1 : 0, f ? sizeof *f + size_of(f) : 0};
    static const char zeros[8];
    memcpy(out.kind, kind, strlen(kind));
    fwrite(&out, sizeof out, 1, stdout);
    if (f) {
        fwrite(f, sizeof *f, 1, stdout);
        fwrite(data, 1, bytes, stdout);
        fwrite(zeros, 1, size_of(f) - bytes, stdout);
    }
    fflush(stdout);
}

static void hello(void) {
    const char *text = "{\"needs\": [\"rays\"], \"command\": \"velocity\"}";
    struct field f = {"text", 't', 1, {0}, {strlen(text)}};
    answer("ready", &f, text, strlen(text));
}

/* What is kept of each row (one world): how fast its agents prefer to go. */
static double **speed;
static int64_t rows_known;

static void reset(void) {
    const struct field *about;
    const int64_t *row = get("rows", &about), *agents = get("agents", NULL);
    const double *preferred = get("preferred_speed", NULL);
    for (uint64_t n = 0; n < about->shape[0]; preferred += agents[n], n++) {
        if (row[n] >= rows_known) {
            speed = realloc(speed, (row[n] + 1) * sizeof *speed);
            while (rows_known <= row[n]) speed[rows_known++] = NULL;
        }
        speed[row[n]] = realloc(speed[row[n]], agents[n] * sizeof(double) + 1);
        memcpy(speed[row[n]], preferred, agents[n] * sizeof(double));
    }
    answer("done", NULL, NULL, 0);
}

static double turned(double angle) { return remainder(angle, 8.0 * atan(1.0)); }

/* How far direction k is free: as far as every ray beside it, less what comes nearer. */
static double clear_along(int k, int rays, const double *angle, const double *distance,
                          const double *approach) {
    double least = INFINITY;
    for (int j = 0; j < rays; j++) {
        double nearer = distance[j] - AHEAD * fmax(approach[j], 0.0);
        if (fabs(turned(angle[j] - angle[k])) <= SIDE && nearer < least) least = nearer;
    }
    return least;
}

/* (x, y) [m/s] for an agent that would go `way` to its goal. */
static void steer(const double *way, double heading, double fast, int rays, const double *angle,
                  const double *distance, const double *approach, double *command) {
    double far = hypot(way[0], way[1]), towards = turned(atan2(way[1], way[0]) - heading);
    double least = INFINITY, freest = -INFINITY, clear = 0.0;
    int best = 0;
    for (int k = 0; k < rays; k++) {
        double open = clear_along(k, rays, angle, distance, approach);
        double cost = fabs(turned(angle[k] - towards)) + TURNING * fabs(angle[k]);
        int is_free = open >= fmin(NEAR, far);
        if (is_free ? cost < least : least == INFINITY && open > freest) {
            best = k, clear = open;
            if (is_free) least = cost;
            else freest = open;
        }
    }
    double direction = heading + angle[best];
    double pace = fast * fmin(1.0, fmax(clear, 0.1) / NEAR);
    command[0] = pace * cos(direction);
    command[1] = pace * sin(direction);
}

static void act(void) {
    const struct field *about, *fan;
    const int64_t *row = get("rows", NULL);
    const char *active = get("active", &about);
    const double *position = get("position", NULL), *goal = get("goal", NULL);
    const double *heading = get("heading", NULL), *angle = get("rays.angle", &fan);
    const double *distance = get("rays.distance", NULL), *approach = get("rays.approach", NULL);
    int64_t worlds = about->shape[0], agents = about->shape[1], rays = fan->shape[0];
    double *command = calloc(worlds * agents * 2 + 1, sizeof *command);
    for (int64_t at = 0; at < worlds * agents; at++) {
        double way[2] = {goal[2 * at] - position[2 * at], goal[2 * at + 1] - position[2 * at + 1]};
        if (active[at])
            steer(way, heading[at], speed[row[at / agents]][at % agents], rays, angle,
                  distance + at * rays, approach + at * rays, command + 2 * at);
    }
    struct field f = {"command", 'd', 3, {0}, {worlds, agents, 2}};
    answer("command", &f, command, worlds * agents * 2 * sizeof *command);
    free(command);
}

int main(void) {
    while (read_frame()) {
        if (strncmp(top.kind, "hello", 8) == 0) hello();
        else if (strncmp(top.kind, "reset", 8) == 0) reset();
        else if (strncmp(top.kind, "act", 8) == 0) act();
        else return 2;
    }
    return 0;
}
