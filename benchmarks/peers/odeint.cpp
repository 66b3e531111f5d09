// A rocking block by Boost.Odeint: Dormand-Prince 5 with dense output, impacts located on it by bisection and secants.
// Reads a case from the file named on the command line (see compiled.py), prints CPU time [s] of the fastest of several
// runs and the impact times.  No step is longer than a sample of a record: its kinks are not stepped over unseen.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <vector>

#include "rocking_case.h"

using State = std::array<double, 2>;
namespace ode = boost::numeric::odeint;

static std::vector<double> carry(const Case &c) {
    std::vector<double> impacts;
    double t = 0.0, s = 1.0;
    State y{0.0, 0.0};
    bool resting = true;
    auto flow = [&](const State &x, State &d, double now) {
        d[0] = x[1];
        d[1] = angular_acceleration(&c, s, x[0], now);
    };
    auto stepper = ode::make_dense_output(c.atol, c.rtol, c.max_step, ode::runge_kutta_dopri5<State>());
    while (t < c.t_end) {
        if (resting) {
            t = next_tip(&c, t);
            if (t >= c.t_end) break;
            s = base(&c, t) > 0.0 ? -1.0 : 1.0;
            y = {0.0, 0.0};
            resting = false;
        }
        // Half of a flight as the first step, so that a chatter takes few of them.
        const double pull = std::fabs(angular_acceleration(&c, s, 0.0, t)) + 1e-9;
        double first = std::fabs(y[1]) > 0.0 ? std::fabs(y[1]) / pull : 1e-4;
        stepper.initialize(y, t, std::min(first, c.max_step));
        bool hit = false;
        while (!hit) {
            auto [t0, t1] = stepper.do_step(flow);
            State probe;
            double low = t0, high = t1;
            bool below = false;
            for (int i = 1; i <= 4 && !below; ++i) {  // four looks a step, for a dip that comes back
                high = t0 + (t1 - t0) * i / 4;
                stepper.calc_state(high, probe);
                below = s * probe[0] < 0.0;
                if (!below) low = high;
            }
            if (below) {
                double f_low = 1.0, f_high = s * probe[0];
                stepper.calc_state(low, probe);
                f_low = s * probe[0];
                if (low == t0) f_low = std::max(f_low, 0.0);
                for (int i = 0; i < 100 && high - low > 1e-14 * (1.0 + high); ++i) {
                    double at = i % 2 && f_low > 0.0 ? low + (high - low) * f_low / (f_low - f_high) : 0.5 * (low + high);
                    stepper.calc_state(at, probe);
                    double f = s * probe[0];
                    (f < 0.0 ? high : low) = at;
                    (f < 0.0 ? f_high : f_low) = f;
                }
                t = high;
                stepper.calc_state(t, probe);
                if (t >= c.t_end) return impacts;
                impacts.push_back(t);
                const double after = c.e * probe[1];
                s = -s;
                resting = std::fabs(after) < c.omega_rest && std::fabs(base(&c, t)) <= c.onset * c.g;
                y = {0.0, resting ? 0.0 : after};
                hit = true;
            } else if (t1 >= c.t_end || std::fabs(stepper.current_state()[0]) > 1.5707) {
                return impacts;
            }
        }
    }
    return impacts;
}

int main(int argc, char **argv) {
    const Case c = read_case(argc > 1 ? argv[1] : "case.txt");
    double least = 1e30;
    std::vector<double> impacts;
    for (int run = 0; run < c.runs; ++run) {
        const std::clock_t begin = std::clock();
        impacts = carry(c);
        least = std::min(least, double(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    std::printf("%.9e\n", least);
    for (double at : impacts) std::printf("%.17g\n", at);
}
