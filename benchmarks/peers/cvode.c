/* A rocking block by SUNDIALS' CVODE (Adams) with its root finding; see odeint.cpp for what goes in and out. */
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <time.h>

#include "rocking_case.h"

typedef struct {
    const Case *c;
    double s;
} Task;

static int flow(realtype t, N_Vector y, N_Vector d, void *user) {
    const Task *task = (const Task *)user;
    NV_Ith_S(d, 0) = NV_Ith_S(y, 1);
    NV_Ith_S(d, 1) = angular_acceleration(task->c, task->s, NV_Ith_S(y, 0), t);
    return 0;
}

static int floor_reached(realtype t, N_Vector y, realtype *out, void *user) {
    (void)t;
    out[0] = ((const Task *)user)->s * NV_Ith_S(y, 0);
    return 0;
}

static int carry(const Case *c, void *mem, N_Vector y, Task *task, double *impacts, int room) {
    int count = 0, resting = 1;
    double t = 0.0;
    NV_Ith_S(y, 0) = NV_Ith_S(y, 1) = 0.0;
    while (t < c->t_end) {
        if (resting) {
            t = next_tip(c, t);
            if (t >= c->t_end) break;
            task->s = base(c, t) > 0.0 ? -1.0 : 1.0;
            NV_Ith_S(y, 0) = NV_Ith_S(y, 1) = 0.0;
            resting = 0;
        }
        CVodeReInit(mem, t, y);
        int flag;
        do {
            flag = CVode(mem, c->t_end, y, &t, CV_ONE_STEP);
            if (flag < 0 || fabs(NV_Ith_S(y, 0)) > 1.5707) return count;
        } while (flag != CV_ROOT_RETURN && t < c->t_end);
        if (flag != CV_ROOT_RETURN || t >= c->t_end) break;
        if (count < room) impacts[count] = t;
        ++count;
        const double after = c->e * NV_Ith_S(y, 1);
        task->s = -task->s;
        resting = fabs(after) < c->omega_rest && fabs(base(c, t)) <= c->onset * c->g;
        NV_Ith_S(y, 0) = 0.0;
        NV_Ith_S(y, 1) = resting ? 0.0 : after;
    }
    return count;
}

int main(int argc, char **argv) {
    const Case c = read_case(argc > 1 ? argv[1] : "case.txt");
    SUNContext context;
    SUNContext_Create(NULL, &context);
    N_Vector y = N_VNew_Serial(2, context);
    Task task = {&c, 1.0};
    void *mem = CVodeCreate(CV_ADAMS, context);
    int direction = -1;
    NV_Ith_S(y, 0) = NV_Ith_S(y, 1) = 0.0;
    CVodeInit(mem, flow, 0.0, y);
    CVodeSStolerances(mem, c.rtol, c.atol);
    CVodeSetUserData(mem, &task);
    CVodeSetNonlinearSolver(mem, SUNNonlinSol_FixedPoint(y, 0, context));
    CVodeRootInit(mem, 1, floor_reached);
    CVodeSetRootDirection(mem, &direction);
    CVodeSetNoInactiveRootWarn(mem);
    CVodeSetMaxStep(mem, c.max_step);
    CVodeSetMaxNumSteps(mem, 100000000);
    double *impacts = (double *)malloc(sizeof(double) * 100000), least = 1e30;
    int count = 0;
    for (int run = 0; run < c.runs; ++run) {
        const clock_t begin = clock();
        count = carry(&c, mem, y, &task, impacts, 100000);
        const double took = (double)(clock() - begin) / CLOCKS_PER_SEC;
        if (took < least) least = took;
    }
    printf("%.9e\n", least);
    for (int i = 0; i < count && i < 100000; ++i) printf("%.17g\n", impacts[i]);
    return 0;
}
