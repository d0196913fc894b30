/* Ride model of a road vehicle: equations of motion assembled from the tables in model.h, and their integration.

   Displacements X count from where springs and tyres have no force. The state is X, the velocities V of the coordinates with
   mass (the first N_MASSIVE), and the memories of dry friction. The highest derivatives are the accelerations of the coordinates
   with mass, the velocities of those without, and the accelerations of those on which no force acts. */

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { MASS, DAMPER, SPRING };
enum { FRICTION, LOAD_FRICTION, UNEVEN_FRICTION, REBOUND, DAMPER_CURVE, PROGRESSIVE, AIR, BUMP_STOP };

/* A parameter is given by its number; -1 stands for none, and as a factor for 1. */
typedef struct { int row, coordinate, parameter; double value; } RowEntry;
typedef struct { int law, row, parameter; double factor, offset; } Element;
typedef struct { int law, row, count, parameters[12], has_ratio, has_rebound_knee, is_rounded, memory; double offset, factor; } Force;
typedef struct { int coordinate, stiffness, difference, damping, growth; double side; } Tyre;
typedef struct { int output, order, coordinate, parameter; double value; } OutputEntry;
typedef struct { int output, wheel; } TyreOutput;

#include "model.h"

#define STATES (N_FORCED + N_MASSIVE + N_MEMORIES)
#define STAGES 7
#define ITERATIONS 100

typedef struct {
    double parameter[N_PARAMETERS + 1];
    double road[N_WHEELS], road_rate[N_WHEELS];
    double M[N_ALL][N_ALL], C[N_ALL][N_ALL], K[N_ALL][N_ALL], weight[N_ALL];
    double row[N_ROWS][N_ALL];
    double inverse[N_ALL][N_ALL];
    double state[STATES];
    double highest[N_ALL];
    double time, road_time, step, tolerance;
} Vehicle;

static double value(const Vehicle *vehicle, int parameter) {
    return parameter < 0 ? 1.0 : vehicle->parameter[parameter];
}

/* Solve A x = b in place by Gaussian elimination with pivoting; 0 if A is singular. */
static int solve(int n, double A[N_ALL][N_ALL], double *b) {
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i][k]) > fabs(A[pivot][k])) pivot = i;
        if (!(fabs(A[pivot][k]) > 0.0)) return 0;
        for (int j = 0; j < n; j++) {
            double kept = A[k][j];
            A[k][j] = A[pivot][j];
            A[pivot][j] = kept;
        }
        double kept = b[k];
        b[k] = b[pivot];
        b[pivot] = kept;
        for (int i = k + 1; i < n; i++) {
            double factor = A[i][k] / A[k][k];
            for (int j = k; j < n; j++) A[i][j] -= factor * A[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) b[k] -= A[k][j] * b[j];
        b[k] /= A[k][k];
    }
    return 1;
}

/* Coefficient of the highest derivative of coordinate j in the equation of coordinate i. */
static double leading(const Vehicle *vehicle, int i, int j) {
    return j < N_MASSIVE || j >= N_FORCED ? vehicle->M[i][j] : vehicle->C[i][j];
}

static int assemble(Vehicle *vehicle) {
    memset(vehicle->M, 0, sizeof vehicle->M);
    memset(vehicle->C, 0, sizeof vehicle->C);
    memset(vehicle->K, 0, sizeof vehicle->K);
    memset(vehicle->row, 0, sizeof vehicle->row);
    memset(vehicle->weight, 0, sizeof vehicle->weight);
    for (size_t i = 0; i < sizeof row_entries / sizeof *row_entries; i++) {
        const RowEntry *one = &row_entries[i];
        vehicle->row[one->row][one->coordinate] += one->value * value(vehicle, one->parameter);
    }
    for (size_t e = 0; e < sizeof elements / sizeof *elements; e++) {
        const Element *one = &elements[e];
        double (*A)[N_ALL] = one->law == MASS ? vehicle->M : one->law == DAMPER ? vehicle->C : vehicle->K;
        const double *g = vehicle->row[one->row];
        double size = one->factor * value(vehicle, one->parameter);
        for (int i = 0; i < N_ALL; i++)
            for (int j = 0; j < N_ALL; j++) A[i][j] += size * g[i] * g[j];
        if (one->law == SPRING)
            for (int i = 0; i < N_ALL; i++) vehicle->weight[i] -= size * one->offset * g[i];
    }
    for (int i = 0; i < N_ALL; i++)
        for (int j = 0; j < N_FORCED; j++) vehicle->weight[i] += GRAVITY * vehicle->M[i][j] * heave[j];
    for (int k = 0; k < N_ALL; k++) {
        double A[N_ALL][N_ALL], b[N_ALL] = {0};
        for (int i = 0; i < N_ALL; i++)
            for (int j = 0; j < N_ALL; j++) A[i][j] = leading(vehicle, i, j);
        b[k] = 1.0;
        if (!solve(N_ALL, A, b)) return 0;
        for (int i = 0; i < N_ALL; i++) vehicle->inverse[i][k] = b[i];
    }
    return 1;
}

/* Mean rate of an air spring between rest and a strain, over that at rest, less one. */
static double air_ratio(double strain) {
    const double n = 1.3;
    if (fabs(strain) < 1e-4) return (n + 1.0) * strain * (-0.5 + (n + 2.0) * strain / 6.0);
    return (1.0 - pow(fmax(1.0 + strain, 0.05), -n)) / (n * strain) - 1.0;
}

/* What the knots of a damper's curve add to its force. */
static double damper_curve(const Vehicle *vehicle, const Force *force, double rate) {
    const int *p = force->parameters + 1;
    double ratio = force->has_ratio ? value(vehicle, *p++) : 1.0;
    double shift = force->has_rebound_knee ? value(vehicle, *p++) : 1.0;
    double bend = force->has_rebound_knee ? value(vehicle, *p++) : 1.0;
    double width = force->is_rounded ? value(vehicle, *p++) : 0.0;
    double slope = 1.0, missing = 0.0, size = fabs(rate);
    if (rate <= 0.0) shift = bend = 1.0;
    width *= shift;
    for (; p < force->parameters + force->count; p += 2) {
        double velocity = shift * value(vehicle, p[0]), factor = bend * value(vehicle, p[1]), beyond = size - velocity;
        double excess = 0.5 * (beyond + hypot(beyond, width)) - 0.5 * (hypot(velocity, width) - velocity);
        missing += slope * (1.0 - factor) * excess;
        slope *= factor;
        bend = 1.0;
    }
    return -value(vehicle, force->parameters[0]) * (rate > 0.0 ? ratio : -1.0) * missing;
}

static double law(const Vehicle *vehicle, const Force *force, double travel, double rate, const double *memory) {
    double p = value(vehicle, force->parameters[0]), q = force->count > 1 ? value(vehicle, force->parameters[1]) : 0.0;
    double x = travel - force->offset;
    switch (force->law) {
    case FRICTION: return p * memory[force->memory];
    case LOAD_FRICTION: return force->factor * p * memory[force->memory];
    case UNEVEN_FRICTION: return (q + force->factor * p) * memory[force->memory];
    case REBOUND: return (p - 1.0) * q * fmax(rate, 0.0);
    case DAMPER_CURVE: return damper_curve(vehicle, force, rate);
    case PROGRESSIVE: return -0.5 * p * q * x * x;
    case AIR: return q * x * air_ratio(p * x);
    case BUMP_STOP: return -p * fmax(-x - q, 0.0);
    }
    return 0.0;
}

static double dot(const double *one, const double *other, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += one[i] * other[i];
    return sum;
}

/* Force of the ground on a tyre: it pushes and never pulls. */
static double tyre_force(const Vehicle *vehicle, int wheel, double rise, double rate) {
    const Tyre *tyre = &tyres[wheel];
    double stiffness = value(vehicle, tyre->stiffness), damping = tyre->damping < 0 ? 0.0 : value(vehicle, tyre->damping);
    if (tyre->difference >= 0) stiffness += tyre->side * value(vehicle, tyre->difference);
    double pressing = fmax(-stiffness * rise - damping * rate, 0.0), deflection = fmin(rise, 0.0);
    if (tyre->growth >= 0)
        pressing += 0.5 * value(vehicle, tyre->growth) * value(vehicle, tyre->stiffness) * deflection * deflection;
    return pressing;
}

static double road_at(const Vehicle *vehicle, int wheel, double time) {
    return vehicle->road[wheel] + vehicle->road_rate[wheel] * (time - vehicle->road_time);
}

static double rise_of(const Vehicle *vehicle, int wheel, double time, const double *X) {
    return X[tyres[wheel].coordinate] - road_at(vehicle, wheel, time);
}

/* Forces on all coordinates that do not depend on the highest derivatives. */
static void forces_on(const Vehicle *vehicle, double time, const double *X, const double *V, double *Q) {
    for (int i = 0; i < N_ALL; i++) {
        Q[i] = -vehicle->weight[i];
        if (i < N_FORCED) Q[i] -= dot(vehicle->K[i], X, N_FORCED) + dot(vehicle->C[i], V, N_MASSIVE);
    }
    for (int wheel = 0; wheel < N_WHEELS; wheel++) {
        int at = tyres[wheel].coordinate;
        Q[at] += tyre_force(vehicle, wheel, rise_of(vehicle, wheel, time, X), V[at] - vehicle->road_rate[wheel]);
    }
}

/* Highest derivatives. Where a nonlinear damper acts on a coordinate without mass they are found by Newton's method. */
static void highest_derivatives(const Vehicle *vehicle, double time, const double *state, double *highest) {
    const double *X = state, *V = state + N_FORCED, *memory = V + N_MASSIVE;
    double Q[N_ALL], velocity[N_FORCED], best = HUGE_VAL, change[N_ALL] = {0}, size = 1.0;
    forces_on(vehicle, time, X, V, Q);
    memcpy(velocity, V, sizeof(double) * N_MASSIVE);
    for (int k = 0; k < ITERATIONS; k++) {
        double R[N_ALL], J[N_ALL][N_ALL], largest = 0.0, scale = 1.0;
        for (int i = N_MASSIVE; i < N_FORCED; i++) velocity[i] = IS_COUPLED ? highest[i] : 0.0;
        for (int i = 0; i < N_ALL; i++) {
            R[i] = Q[i];
            for (int j = 0; j < N_ALL; j++) J[i][j] = leading(vehicle, i, j);
        }
        for (int e = 0; e < N_FORCES; e++) {
            const double *g = vehicle->row[forces[e].row];
            double travel = dot(g, X, N_FORCED), rate = dot(g, velocity, N_FORCED), h = 1e-7, slope = 0.0;
            double force = law(vehicle, &forces[e], travel, rate, memory);
            if (IS_COUPLED)
                slope = (law(vehicle, &forces[e], travel, rate + h, memory)
                         - law(vehicle, &forces[e], travel, rate - h, memory)) / (2.0 * h);
            for (int i = 0; i < N_FORCED; i++) {
                R[i] -= g[i] * force;
                for (int j = N_MASSIVE; j < N_FORCED; j++) J[i][j] += slope * g[i] * g[j];
            }
        }
        if (!IS_COUPLED) {
            for (int i = 0; i < N_ALL; i++) highest[i] = dot(vehicle->inverse[i], R, N_ALL);
            return;
        }
        for (int i = 0; i < N_ALL; i++) {
            scale = fmax(scale, fabs(R[i]));
            for (int j = 0; j < N_ALL; j++) R[i] -= leading(vehicle, i, j) * highest[j];
        }
        for (int i = 0; i < N_ALL; i++) largest = fmax(largest, fabs(R[i]));
        if (largest <= 1e-11 * scale) return;
        if (largest >= best && size > 1e-3) {
            size *= 0.5;
            for (int i = 0; i < N_ALL; i++) highest[i] -= size * change[i];
            continue;
        }
        best = largest;
        size = 1.0;
        if (!solve(N_ALL, J, R)) return;
        memcpy(change, R, sizeof R);
        for (int i = 0; i < N_ALL; i++) highest[i] += change[i];
    }
}

static void derivative(Vehicle *vehicle, double time, const double *state, double *rate) {
    const double *V = state + N_FORCED, *memory = V + N_MASSIVE;
    double velocity[N_FORCED];
    highest_derivatives(vehicle, time, state, vehicle->highest);
    memset(rate, 0, sizeof(double) * STATES);
    for (int i = 0; i < N_FORCED; i++) rate[i] = velocity[i] = i < N_MASSIVE ? V[i] : vehicle->highest[i];
    for (int i = 0; i < N_MASSIVE; i++) rate[N_FORCED + i] = vehicle->highest[i];
    for (int e = 0; e < N_FORCES; e++) {
        const Force *one = &forces[e];
        if (one->memory < 0) continue;
        double moving = dot(vehicle->row[one->row], velocity, N_FORCED);
        double limit = value(vehicle, one->parameters[one->count - 2]);
        /* Without a force the memory has no effect, and would only shorten the steps. */
        if (value(vehicle, one->parameters[one->law == UNEVEN_FRICTION]) == 0.0) continue;
        double length = fmax(fabs(limit) / value(vehicle, one->parameters[one->count - 1]), 1e-7);
        rate[N_FORCED + N_MASSIVE + one->memory] = (moving - fabs(moving) * memory[one->memory]) / length;
    }
}

/* Find the position of rest on the road as it is: Newton's method with halved steps where they lead away. */
static int find_rest(Vehicle *vehicle) {
    double *X = vehicle->state, none[STATES] = {0}, change[N_ALL] = {0}, best = HUGE_VAL, size = 1.0;
    double at_rest[N_MEMORIES + 1] = {0};
    memset(X, 0, sizeof vehicle->state);
    /* From the rest of the vehicle as it was exported, on flat road at the mean height of this one. */
    for (int i = 0; i < N_FORCED; i++) X[i] = rest[i];
    for (int wheel = 0; wheel < N_WHEELS; wheel++)
        for (int i = 0; i < N_FORCED; i++) X[i] += heave[i] * vehicle->road[wheel] / N_WHEELS;
    for (int k = 0; k < ITERATIONS; k++) {
        double R[N_ALL], J[N_ALL][N_ALL], largest = 0.0, scale = 1.0;
        forces_on(vehicle, vehicle->time, X, none, R);
        memcpy(J, vehicle->K, sizeof J);
        for (int wheel = 0; wheel < N_WHEELS; wheel++) {
            /* In the first step every tyre is taken to press. */
            double rise = k > 0 ? rise_of(vehicle, wheel, vehicle->time, X) : -1.0, h = 1e-8;
            int at = tyres[wheel].coordinate;
            J[at][at] -= (tyre_force(vehicle, wheel, rise + h, 0.0) - tyre_force(vehicle, wheel, rise - h, 0.0)) / (2.0 * h);
        }
        for (int e = 0; e < N_FORCES; e++) {
            const double *g = vehicle->row[forces[e].row];
            double travel = dot(g, X, N_FORCED), h = 1e-8, force = law(vehicle, &forces[e], travel, 0.0, at_rest);
            double slope = (law(vehicle, &forces[e], travel + h, 0.0, at_rest)
                            - law(vehicle, &forces[e], travel - h, 0.0, at_rest)) / (2.0 * h);
            for (int i = 0; i < N_FORCED; i++) {
                R[i] -= g[i] * force;
                for (int j = 0; j < N_FORCED; j++) J[i][j] += slope * g[i] * g[j];
            }
        }
        for (int i = 0; i < N_FORCED; i++) {
            int is_free = 1;
            for (int j = 0; j < N_FORCED; j++) is_free = is_free && vehicle->K[i][j] == 0.0;
            if (is_free && i >= N_MASSIVE) J[i][i] = 1.0;
            largest = fmax(largest, fabs(R[i]));
            scale = fmax(scale, fabs(vehicle->weight[i]));
        }
        if (largest <= 1e-10 * scale) return 1;
        if (largest >= best && k > 1 && size > 1e-4) {
            size *= 0.5;
            for (int i = 0; i < N_FORCED; i++) X[i] -= size * change[i];
            continue;
        }
        best = largest;
        size = 1.0;
        if (!solve(N_FORCED, J, R)) return 0;
        memcpy(change, R, sizeof R);
        for (int i = 0; i < N_FORCED; i++) X[i] += change[i];
    }
    return 0;
}

/* Begin at rest on the road as it is now: it does not move before. */
static int initialise(Vehicle *vehicle) {
    double road_rate[N_WHEELS];
    vehicle->step = 1e-4;
    vehicle->road_time = vehicle->time;
    memset(vehicle->highest, 0, sizeof vehicle->highest);
    memcpy(road_rate, vehicle->road_rate, sizeof road_rate);
    memset(vehicle->road_rate, 0, sizeof vehicle->road_rate);
    int found = assemble(vehicle) && find_rest(vehicle);
    memcpy(vehicle->road_rate, road_rate, sizeof road_rate);
    return found;
}

/* Integrate to a time with the method of Dormand and Prince (J. Comput. Appl. Math. 6, 1980), step by its own error. */
static int integrate(Vehicle *vehicle, double until) {
    static const double a[STAGES][STAGES - 1] = {
        {0},
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double c[STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
    static const double difference[STAGES] = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525,
                                              -1.0 / 40};
    const double shortest = 1e-9;
    while (vehicle->time < until) {
        double rate[STAGES][STATES], next[STATES], error = 0.0, left = until - vehicle->time;
        int is_last = vehicle->step >= left * (1.0 - 1e-9);
        double step = is_last ? left : vehicle->step;
        for (int s = 0; s < STAGES; s++) {
            for (int i = 0; i < STATES; i++) {
                next[i] = vehicle->state[i];
                for (int r = 0; r < s; r++) next[i] += step * a[s][r] * rate[r][i];
            }
            derivative(vehicle, vehicle->time + c[s] * step, next, rate[s]);
        }
        for (int i = 0; i < STATES; i++) {
            double off = 0.0, size = fmax(fabs(next[i]), fabs(vehicle->state[i]));
            for (int s = 0; s < STAGES; s++) off += step * difference[s] * rate[s][i];
            if (!isfinite(next[i])) return 0;
            error = fmax(error, fabs(off) / (vehicle->tolerance * (size + (i < N_FORCED ? 1e-2 : 1.0))));
        }
        double factor = error > 0.0 ? 0.9 * pow(error, -0.2) : 5.0;
        if (error <= 1.0 || step <= shortest) {
            vehicle->time = is_last ? until : vehicle->time + step;
            memcpy(vehicle->state, next, sizeof next);
            if (!is_last || factor < 1.0) vehicle->step = step * fmin(fmax(factor, 0.2), 5.0);
        } else {
            vehicle->step = fmax(step * fmax(factor, 0.1), shortest);
        }
    }
    return 1;
}

static void outputs_at(Vehicle *vehicle, double *output) {
    const double *X = vehicle->state, *V = X + N_FORCED;
    double part[3][N_FORCED], rate[STATES];
    derivative(vehicle, vehicle->time, vehicle->state, rate);
    for (int i = 0; i < N_FORCED; i++) {
        part[0][i] = X[i];
        part[1][i] = rate[i];
        part[2][i] = i < N_MASSIVE ? vehicle->highest[i] : 0.0;
    }
    memcpy(output, output_offsets, sizeof output_offsets);
    for (size_t i = 0; i < sizeof output_entries / sizeof *output_entries; i++) {
        const OutputEntry *one = &output_entries[i];
        output[one->output] += one->value * value(vehicle, one->parameter) * part[one->order][one->coordinate];
    }
    for (size_t i = 0; i < sizeof tyre_outputs / sizeof *tyre_outputs; i++) {
        int wheel = tyre_outputs[i].wheel, at = tyres[wheel].coordinate;
        double rise = rise_of(vehicle, wheel, vehicle->time, X);
        output[tyre_outputs[i].output] = tyre_force(vehicle, wheel, rise, V[at] - vehicle->road_rate[wheel]);
    }
}
