// The rocking block and its base motion, for the compiled peers.
#ifndef ROCKING_CASE_H
#define ROCKING_CASE_H
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    int linear, record, runs, n;
    double p2, alpha, g, onset, e, omega_rest, t_end, rtol, atol, max_step, omega, rate, dt;
    double *values;
} Case;

static inline Case read_case(const char *path) {
    Case c;
    FILE *f = fopen(path, "r");
    if (!f || fscanf(f, "%d %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %d", &c.linear, &c.record, &c.runs,
                     &c.p2, &c.alpha, &c.g, &c.onset, &c.e, &c.omega_rest, &c.t_end, &c.rtol, &c.atol, &c.max_step,
                     &c.omega, &c.rate, &c.dt, &c.n) != 17)
        exit(1);
    c.values = (double *)malloc(sizeof(double) * (size_t)(c.n + 1));
    for (int i = 0; i < c.n; ++i)
        if (fscanf(f, "%lf", &c.values[i]) != 1) exit(1);
    fclose(f);
    return c;
}

static inline double base(const Case *c, double t) {
    if (!c->record) return c->rate * t * sin(c->omega * t);
    int k = (int)(t / c->dt);
    if (k > c->n - 2) k = c->n - 2;
    return c->values[k] + (t / c->dt - k) * (c->values[k + 1] - c->values[k]);
}

static inline double angular_acceleration(const Case *c, double s, double theta, double t) {
    const double psi = c->alpha - s * theta, push = base(c, t) / c->g;
    return c->linear ? -c->p2 * (s * psi + push) : -c->p2 * (s * sin(psi) + push * cos(psi));
}

// First time from t on at which |a_x| exceeds the threshold; t_end if it does not.
static inline double next_tip(const Case *c, double t) {
    const double limit = c->onset * c->g, step = c->record ? c->dt : 0.01 / c->omega;
    double a = t;
    if (fabs(base(c, a)) > limit) return a;
    while (a < c->t_end) {
        double b = c->record ? (floor(a / step + 1e-9) + 1.0) * step : a + step;
        if (fabs(base(c, b)) > limit) {
            for (int i = 0; i < 60; ++i) {
                const double m = 0.5 * (a + b);
                if (fabs(base(c, m)) > limit) b = m; else a = m;
            }
            return b;
        }
        a = b;
    }
    return c->t_end;
}
#endif
