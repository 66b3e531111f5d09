"""What the paper says that can be checked, and what decides: written down before the first result.

Where the paper gives no number, the bound is what its words mean, and where they compare with the tests, the scatter of
10 to 20 per cent that it reports for them.  A bound is not moved afterwards; a claim that does not hold stays so.

Source   Winkler, Meguro & Yamazaki (1995), section or figure in `place`
Status   see `python -m studies.claims`
"""

from __future__ import annotations

from studies.running.statements import Claim

ROCKING = "Criteria of rocking for single blocks"
SINGLE = "Criteria of overturning for single blocks"
ASSEMBLIES = "Block assemblies"
TESTS = "Shaking table experiments"

COLUMN_PARAMETERS = "growth of the ramp, friction, dashpot; scatter under tiny changes is in the dataset"

_ALL = (
    # Reading of records.
    Claim(
        "fig02.detection", "The start of rocking can be read off the vertical record of a pickup on the block",
        f"{TESTS}, Fig. 2", "largest |a_x(read) / a_x(true) - 1|, peak of the base so far", "<=", 0.10,
        depends="noise of the pickup, growth of the ramp",
    ),
    Claim(
        "fig03.detection", "The moment of overturning can be read off the vertical record of the upper block",
        f"{TESTS}, Fig. 3", "largest |envelope(read) / envelope(true) - 1|", "<=", 0.05,
        depends="noise of the pickup, growth of the ramp",
    ),
    # Start of rocking.
    Claim(
        "fig14.lift", "Distinct elements lift off at (b/h) g, whatever the size", f"{ROCKING}, Fig. 14",
        "largest departure of |a_x| at lift-off from (b/h) g", "<=", 0.02, depends="stiffness, dashpot",
    ),
    Claim(
        "fig14.motion", "Motion follows at (b/h) g by every method, whatever the size", f"{ROCKING}, Fig. 14",
        "largest |a_x| until a corner is 0.05 mm off the floor, largest departure from (b/h) g", "<=", 0.10,
        depends="growth of the ramp, what counts as motion",
    ),
    Claim(
        "fig14.size", "Size makes no difference to the start of rocking", f"{ROCKING}, Fig. 14",
        "largest spread over the blocks at one frequency and method, over the mean", "<=", 0.10,
        depends="growth of the ramp, what counts as motion",
    ),
    Claim(
        "fig15.motion", "Motion follows at (b/h) g by every method, whatever the slenderness", f"{ROCKING}, Fig. 15",
        "largest |a_x| until a corner is 0.05 mm off the floor, largest departure from (b/h) g", "<=", 0.10,
        depends="growth of the ramp, what counts as motion",
    ),
    Claim(
        "fig15.constant", "The analytic criteria hardly depend on frequency", f"{ROCKING}, Fig. 15",
        "change from 1 to 5 Hz along the straight line of best fit over the mean, largest of the blocks", "<=", 0.05,
        depends="growth of the ramp, what counts as motion",
    ),
    Claim(
        "fig15.methods", "Methods 1 and 2 do not differ on the start of rocking", ROCKING,
        "largest |Method 2 / Method 1 - 1|", "<=", 0.01, depends="friction above b/h",
    ),
    Claim(
        "fig15.envelope", "An uneven envelope bends the criteria of rocking", f"{ROCKING}, after Fig. 15",
        "largest change by an envelope that is uneven by 10 % (Method 1)", ">=", 0.02,
        depends="size and period of the unevenness",
    ),
    Claim(
        "fig15.slender_base", "Slender blocks feel the condition of their base more than stocky ones",
        f"{ROCKING}, Fig. 15", "change for Block 7 over that for Block 5, smallest of pitch, tilt, worn edges", ">",
        1.05, depends="none at small disturbances",
    ),
    Claim(
        "fig15.slender_vertical", "Slender blocks feel vertical disturbance more than stocky ones",
        f"{ROCKING}, Fig. 15", "change for Block 7 over that for Block 5 under vertical motion", ">", 1.05,
        depends="phase of the vertical motion",
    ),
    Claim(
        "fig15.pitch", "A pitch of the table that would explain 10 % of scatter (Block 3, 5 Hz)", ROCKING,
        "amplitude of pitch", units="rad", depends="height of the axis of pitch, phase",
    ),
    Claim(
        "fig15.worn", "Worn edges that would explain 10 % of scatter (Block 3)", ROCKING, "radius of the edges",
        units="m", depends="shape of the wear",
    ),
    Claim(
        "fig15.vertical", "Vertical motion that would explain 10 % of scatter", ROCKING, "vertical over horizontal",
        depends="phase of the vertical motion",
    ),
    Claim(
        "fig15.inclination", "A pitching table makes the criteria fall with frequency, as some of the tests do",
        f"{ROCKING}, Fig. 15", "change from 1 to 5 Hz over the mean with a pitch of 0.5 mrad (Block 3)", "<", 0.0,
        depends="phase of the pitch",
    ),
    # Overturning of single blocks.
    Claim(
        "fig16.linear", "Method 1 grows almost linearly with frequency", f"{SINGLE}, Fig. 16",
        "smallest r^2 over the blocks", ">=", 0.9, depends="restitution, growth of the ramp",
    ),
    Claim(
        "fig16.alike", "Method 2 and DEM are alike and far from Method 1 beyond 3 Hz", f"{SINGLE}, Fig. 16",
        "distance of Method 2 from DEM over that of Method 1 from DEM (log)", "<=", 0.5,
        depends="friction, impact law, dashpot",
    ),
    Claim(
        "fig16.beyond", "Method 2 and DEM differ most beyond 3 Hz", "Conclusion",
        "their distance beyond 3 Hz over that up to 3 Hz (log)", ">", 1.0, depends="friction, impact law, dashpot",
    ),
    Claim(
        "fig16.sliding_method2", "Method 2: at large amplitude (from 3 Hz on) the motion is mostly sliding rotation",
        SINGLE, "share of the second half of the way to overturning", ">", 0.5, depends="friction, growth of the ramp",
    ),
    Claim(
        "fig16.sliding_dem", "DEM: at large amplitude (from 3 Hz on) the motion is mostly sliding rotation",
        SINGLE, "share of the second half of the way to overturning", ">", 0.5, depends="friction, growth of the ramp",
    ),
    Claim(
        "fig16.at_once", "At the lowest frequency blocks overturn as rocking would begin", SINGLE,
        "most periods of any run from West's threshold to overturning", "<=", 1.0, depends="growth of the ramp, size",
    ),
    Claim(
        "slenderness.frequency", "From which frequency rocking precedes overturning depends on b/h", SINGLE,
        "largest over smallest of that frequency over Blocks 5, 6, 3, 7 (Method 2)", ">=", 1.1,
        depends="growth of the ramp, friction",
    ),
    # Jumps and nuances.
    Claim(
        "scatter.short", "Jumps are short", "Analytical response analysis, Method 2",
        "median length of a jump over the period of the base", "<=", 0.1, depends="friction, impact law",
    ),
    Claim(
        "scatter.low", "Jumps are low", "Analytical response analysis, Method 2",
        "median height of a jump over the height of the block", "<=", 0.01, depends="friction, impact law",
    ),
    Claim(
        "scatter.displace", "Jumps displace the block", "Analytical response analysis, Method 2",
        "share of the path of the base point over the floor that is made in jumps", ">=", 0.05,
        depends="friction, impact law",
    ),
    Claim(
        "scatter.nuance", "The smallest nuance changes the final state", "Analytical response analysis, Method 2",
        "largest coefficient of variation of the overturning amplitude under changes of 1e-6", ">=", 0.05,
        depends="frequency, method",
    ),
    # Columns.
    Claim(
        "fig19.low", "Below 2 Hz the free column of two falls before the one next to a wall",
        f"{ASSEMBLIES}, Figs 18, 19", "share of the frequencies below 2 Hz at which its median criterion is lower",
        ">=", 1.0, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig19.high", "Above 2 Hz the column of two next to a wall falls before the free one",
        f"{ASSEMBLIES}, Figs 18, 19", "share of the frequencies above 2 Hz at which its median criterion is lower",
        ">=", 1.0, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig20.together", "The two blocks rock as one at first (3 Hz)", f"{ASSEMBLIES}, Figs 17, 20",
        "periods from the start of rocking until they part", ">=", 3.0, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig20.apart", "Then they rock under different angles until they fall (3 Hz)", f"{ASSEMBLIES}, Figs 17, 20",
        "periods from their parting to overturning", ">=", 1.0, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig20.low", "At low frequency they hardly part", ASSEMBLIES,
        "largest difference of their angles until overturning at the lowest frequency, over alpha", "<=", 0.1,
        depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig20.earlier", "The higher the frequency, the earlier they part", ASSEMBLIES,
        "rank correlation of frequency and time of parting", "<=", -0.7, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig22.stages", "A column of three at 3 Hz rocks as one, opens at one joint, at the other, and falls",
        f"{ASSEMBLIES}, Fig. 22", "stages met in order", ">=", 4.0, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "fig23.falls", "A column of three falls at every frequency", f"{ASSEMBLIES}, Fig. 23",
        "share of the frequencies at which every run falls", ">=", 1.0, depends="end of the ramp",
    ),
    Claim(
        "fig23.west", "It never falls below West's acceleration of the column as one block", f"{ASSEMBLIES}, Fig. 23",
        "smallest criterion over b/(3 h) g", ">=", 1.0, depends="none",
    ),
    # Further statements.
    Claim(
        "dead_reckoning.short", "Integrating the accelerometers works over 7 s",
        "Distinct element simulation, Material parameters",
        "median error of the displacement of the top over its peak, angle known to 0.1 mrad, after 7 s", "<=", 0.2,
        depends="noise, calibration and initial angle of the pickups",
    ),
    Claim(
        "dead_reckoning.altered", "The same with the angle altered until it converges, as the paper did",
        "Distinct element simulation, Material parameters", "median error of the displacement over its peak after 7 s",
        depends="noise, calibration and initial angle of the pickups",
    ),
    Claim(
        "dead_reckoning.long", "It does not work over 90 s", "Distinct element simulation, Material parameters",
        "median error over the peak, angle known to 0.1 mrad, after 90 s", ">=", 1.0,
        depends="noise, calibration and initial angle of the pickups",
    ),
    Claim(
        "dead_reckoning.angle", "It hangs on the initial angle above all",
        "Distinct element simulation, Material parameters",
        "median error after 7 s by 1 mrad of angle over that by 1 % of calibration", ">", 1.0,
        depends="size of the two errors",
    ),
    Claim(
        "springs.alike", "A two-spring foundation and the contact of distinct elements behave alike", "Introduction",
        "largest difference of the tilt over the first four swings, over the tilt at release", "<=", 0.1,
        depends="dashpot, stiffness",
    ),
    # Beyond the paper: what it asks for, and checks of what is computed.
    Claim(
        "loop_fig16.traced", "What Method 1 lacks at high amplitude is sliding (found by the loop)",
        f"{SINGLE}, Fig. 16",
        "whether sliding is what it names, alone or among at most three", ">=", 1.0, depends="noise of the records",
    ),
    Claim(
        "loop_fig16.friction", "The loop measures the friction of the laboratory", "asked for beyond the paper",
        "|friction found / friction - 1|", "<=", 0.05, depends="noise of the records",
    ),
    Claim(
        "loop_fig16.closed", "Sliding is what separates Method 1 from Method 2 beyond 3 Hz", f"{SINGLE}, Fig. 16",
        "mean |log(after / laboratory)| over mean |log(before / laboratory)| beyond 3 Hz", "<=", 0.25,
        depends="scatter of criteria under tiny changes",
    ),
    Claim(
        "wall_gap.far", "A wall out of reach changes nothing", "asked for in Block assemblies",
        "largest |wall / free - 1| with the widest gap where the free column falls before its blocks part", "<=", 0.01,
        depends="none",
    ),
    Claim(
        "wall_gap.frequency", "Whether a wall helps or hurts depends on the frequency", "asked for in Block assemblies",
        "largest over smallest of wall / free over the frequencies, no gap", ">=", 1.25, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "wall_gap.gap", "The width of the gap matters", "asked for in Block assemblies",
        "largest over smallest of wall / free over the gaps at one frequency", ">=", 1.25, depends=COLUMN_PARAMETERS,
    ),
    Claim(
        "tombstones.ishiyama", "Blocks that fall have been above both limits of Ishiyama (1982)",
        "beyond the paper; its reference 8", "share of falls below one of the two", "<=", 0.05,
        depends="frequency content of the motion, restitution",
    ),
    Claim(
        "tombstones.velocity", "Peak velocity tells falls better than peak acceleration", "beyond the paper",
        "scatter of the least felling velocity over its limit, over that of the acceleration (log, all blocks)", "<",
        1.0, depends="frequency content of the motion",
    ),
    Claim(
        "tombstones.larger", "Of two stones of one shape the larger is the safer", "beyond the paper",
        "smallest ratio of median felling accelerations, next larger over smaller stone", ">=", 1.0,
        depends="frequency content of the motion",
    ),
    Claim(
        "earthquakes.column", "A column of two falls earlier than one block of its outline", "beyond the paper",
        "share of the motions that fell one of them in which it does", ">", 0.5, depends="motions, friction",
    ),
    Claim(
        "earthquakes.vertical", "Vertical motion changes little of who falls", "beyond the paper",
        "share of the motions that fell a scene whose least felling peak is another one of the grid, larger of the two",
        "<=", 0.2,
        depends="motions, size of the vertical motion, width of the classes of acceleration",
    ),
    Claim(
        "tombstones.misleads", "West's formula turned round misleads", "Introduction",
        "95th percentile of how far, as a factor, the estimate is from the true peak", ">=", 2.0,
        depends="size of the stones, frequency content of the motion",
    ),
)  # fmt: skip

CLAIMS = {claim.key: claim for claim in _ALL}
"""All claims by key."""
