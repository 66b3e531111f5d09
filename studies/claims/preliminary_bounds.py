"""What the paper says of its preliminary analyses, and what decides; written down before the figures were drawn.

Where the paper gives no number, the bound is what its words mean.

Source   Winkler, Meguro & Yamazaki (1995), section "Preliminary analyses"
Status   a claim that does not hold stays so
"""

from __future__ import annotations

from studies.running.statements import Claim

STABILITY = "Numerical stability"
MATERIAL = "Material parameters"
DROP = "height of the drop, number of samples"
FREE = "restitution that stands for the experiment, tilt at release"

_ALL = (
    Claim(
        "fig10.undamped", "The rebounding block oscillates without damping", f"{STABILITY}, Fig. 10",
        "height after the last rebound over that of the drop, pivot, smallest", ">=", 0.99, depends=DROP,
    ),
    Claim(
        "fig11.seemingly", "A motion that looks stable need not be right", f"{STABILITY}, Fig. 11",
        "of the nine steps, those whose block never rises above 1.1 drop heights and yet is off by more than a tenth "
        "of one (root mean square)", ">=", 1.0, depends=DROP,
    ),
    Claim(
        "fig12.eq7", "Eq. (7) gives a critical step of about 5e-4 s for the lightest block", STABILITY,
        "|eq. (7) / 5e-4 s - 1|", "<=", 0.1,
    ),
    Claim(
        "fig12.far_below", "The histories depart from the pivot far below that step", f"{STABILITY}, Fig. 12",
        "smallest of the nine steps that is off by more than a hundredth of the drop (root mean square), over eq. (7)",
        "<=", 0.1, depends=DROP,
    ),
    Claim(
        "fig12.lost", "Stability is lost beyond 3.3e-6 s: from there on eq. (8) grows faster than before",
        f"{STABILITY}, Fig. 12",
        "slope of log dy over log dt from 3.3e-6 s to the next step, over the slope from the smallest step to 3.3e-6 s",
        ">=", 2.0, depends=DROP,
    ),
    Claim(
        "fig12.seen", "On a linear axis eq. (8) rises from zero beyond 3.3e-6 s", f"{STABILITY}, Fig. 12",
        "dy at 3.3e-6 s over that at the fifth step", "<=", 0.2, depends=f"{DROP}, fifth step",
    ),
    Claim(
        "fig12.chosen", "2.0e-6 s is appropriate for stable computation", STABILITY,
        "root mean square difference at 2.0e-6 s over the height of the drop", "<=", 0.01, depends=DROP,
    ),
    Claim(
        "fig12.neighbours", "Every surrounding block lowers the step that is needed", STABILITY,
        "largest critical step of a column over that with one block fewer", "<", 1.0,
    ),
    Claim(
        "fig12.larger", "A located onset of contact is as accurate at a step 20 times that of the paper",
        "not in the paper",
        "largest step at which a located onset is no farther from the closed form than the paper's rule at 2.0e-6 s, "
        "over 2.0e-6 s", ">=", 20.0, depends=DROP,
    ),
    Claim(
        "fig12.as_pivot", "A located onset has the accuracy of the pivot at a step 20 times that of the pivot",
        "not in the paper",
        "largest step at which a located onset is no farther from the closed form than the pivot of 1.375e-7 s, over "
        "that", ">=", 20.0, depends=DROP,
    ),
    Claim(
        "fig05.fit", "A damping is found with which distinct elements coincide with the analytical curve",
        f"{MATERIAL}, Fig. 5", "root mean square difference of the top over 7 s, over its displacement at release",
        "<=", 0.05, depends=FREE,
    ),
    Claim(
        "fig05.stiffness", "The spring constant moves the frequency of rocking more than the amplitude", MATERIAL,
        "|change of the frequency of four swings| over |change of the fourth peak| (log) when the stiffness is "
        "doubled, dashpot kept", ">", 1.0, depends=FREE,
    ),
    Claim(
        "fig05.damping", "The damping parameter moves the amplitude more than the frequency", MATERIAL,
        "|change of the fourth peak| over |change of the frequency of four swings| (log) when the dashpot is doubled",
        ">", 1.0, depends=FREE,
    ),
    Claim(
        "fig05.any", "For a range of stiffness there is a damping that fits as closely", MATERIAL,
        "worst best fit over a quarter to four times the stiffness, over that at the paper's stiffness", "<=", 1.5,
        depends=FREE,
    ),
    Claim(
        "fig05.damping_matters", "The accuracy of the damping matters more than that of the stiffness", MATERIAL,
        "root mean square change of the curve by a doubled dashpot over that by a doubled stiffness, dashpot kept",
        ">", 1.0, depends=FREE,
    ),
    Claim(
        "fig05.wave", "Speed of waves from which eq. (9) gives the stiffness (Block 1, centres its height apart)",
        f"{MATERIAL}, eq. (9)", "speed", units="m/s", depends="distance of the centres, which is not printed",
    ),
)  # fmt: skip

CLAIMS = {claim.key: claim for claim in _ALL}
"""The claims by key."""
