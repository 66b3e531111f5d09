"""Which files are physics, and which tests look at each: those that see most of a file soonest come first.

All other default tests of the same folder follow, so that what the table leaves out costs time alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path

# Patterns of files from the root; a folder by itself, so that a new file of physics is taken without being named.
FOLDERS = (
    "rocking", "rocking/effects", "rocking/solvers", "rocking/solvers/*", "dem", "excitation", "studies/laboratory",
)  # fmt: skip
# Not physics: what describes, names, checks arguments, compiles, is plumbing of devices and folders, or draws.
LEFT_OUT = {
    "__init__.py", "__main__.py", "picture.py", "plot.py", "validation.py", "arguments.py", "checks.py",
    "compiled.py", "compiling.py", "_sources.py", "_early.py", "namespace.py", "threads.py", "assembly_threads.py",
    "devices.py", "labelled.py", "datasets.py", "recipes.py", "binding.py", "columns.py", "judge.py", "plans.py",
    "campaign.py", "outcomes.py", "parameters.py", "prediction.py", "truth.py",
}  # fmt: skip
STUDIES = (
    "criteria/overturning", "criteria/columns", "criteria/pickups", "criteria/free_vibration", "fig05/fit",
    "criteria/rocking_onset", "specimens", "slenderness", "springs", "dead_reckoning", "wall_gap", "tombstones",
    "families/numerical_stability", "will_it_fall", "fig03",
)  # fmt: skip

METHOD2 = (
    "test_method2_equations", "test_method2_impacts", "test_method2_transitions", "test_method2_rocking_impacts",
    "test_method2_motion", "test_method2_energy_and_forces", "test_properties", "test_solvers_agree",
)  # fmt: skip
METHOD1 = (
    "test_method1_closed_forms", "test_method1_onset_and_overturning", "effects/test_base_effects",
    "test_physics_under_jax", "test_properties", "test_solvers_agree",
)  # fmt: skip
TAYLOR = (
    "test_chatter_limits",
    "test_taylor",
    "test_exact_batch",
    "test_batch",
    "test_properties",
    "test_maps",
    "test_solvers_agree",
)
EXACT = (
    "test_exact",
    "test_exact_batch",
    "test_solvers_agree",
    "test_other_engines",
    "test_properties",
)
DEVICES = ("test_lanes_of_devices", "test_devices")
DIFFRAX = (
    "test_stretch_limits",
    "test_diffrax_events",
    "test_diffrax_derivatives",
    "test_solvers_agree",
    "test_other_engines",
)
NUMBA = (
    "test_method1_closed_forms", "test_trajectory", "test_method2_motion", "test_solvers_agree", "test_batch",
    "test_batch_with_effects",
)  # fmt: skip
EFFECTS = (
    "effects/test_torque_effects", "effects/test_form_effects", "effects/test_base_effects",
    "effects/test_mode_effects", "effects/test_lagrange", "effects/test_effects_on_instruments",
    "effects/test_effects_contract", "effects/test_effects_given", "effects/test_sensitivity",
)  # fmt: skip
CONTACTS = (
    "test_assembly_contacts", "test_assembly_one_block", "test_energy", "test_assembly_runs", "test_restitution",
    "test_friction",
)  # fmt: skip
ONE_BODY = ("test_energy", "test_friction", "test_restitution", "test_drop", "test_history", "test_against_stiff_ode")
PULSES = ("test_pulses", "test_motion_contract", "test_pitch")
SINES = ("test_harmonic", "test_ramped_sinusoid", "test_longest_steps", "test_motion_contract", "test_pitch")

# The first pattern that fits counts.
FIRST: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("rocking/block.py", ("test_block", "test_method1_closed_forms")),
    ("rocking/form.py", ("effects/test_form_effects", "effects/test_lagrange", "effects/test_effects_beside_sliding")),
    ("rocking/hybrid.py", ("effects/test_base_effects", "test_trajectory", *METHOD1, *METHOD2)),
    ("rocking/method1.py", METHOD1),
    ("rocking/method2*.py", (*METHOD2, "effects/test_method2_of_any_form")),
    (
        "rocking/impacts.py",
        ("test_method2_impacts", "test_method2_rocking_impacts", "effects/test_effects_beside_sliding", *METHOD2),
    ),
    ("rocking/composed_method2.py", ("effects/test_method2_of_any_form", "effects/test_effects_beside_sliding")),
    ("rocking/composed.py", ("effects/test_lagrange", "effects/test_form_effects", "effects/test_torque_effects")),
    ("rocking/altered.py", ("effects/test_base_effects", "effects/test_effects_contract")),
    ("rocking/closed_forms.py", ("test_closed_forms", "test_method1_closed_forms")),
    ("rocking/pulse_overturning.py", ("test_closed_forms", "test_method1_onset_and_overturning")),
    ("rocking/steady_states.py", ("test_steady_states",)),
    ("rocking/fragility*.py", ("test_fragility",)),
    ("rocking/detection.py", ("test_detection",)),
    ("rocking/instruments.py", ("test_instruments", "effects/test_effects_on_instruments")),
    ("rocking/maps.py", ("test_maps",)),
    ("rocking/batch.py", ("test_batch", "test_batch_with_effects", "test_exact_batch")),
    ("rocking/trajectory.py", ("test_trajectory", "test_method1_closed_forms")),
    ("rocking/solve.py", ("test_trajectory", "test_bad_input", "test_solvers_agree")),
    ("rocking/spring_slider.py", ("effects/test_spring_slider",)),
    (
        "rocking/soft_floor.py",
        (
            "effects/test_soft_floor",
            "effects/test_soft_floor_friction",
            "effects/test_winkler_bed",
            "effects/test_effects_on_instruments",
        ),
    ),
    ("rocking/downward_floor.py", ("effects/test_downward_floor",)),
    ("rocking/remembering.py", ("effects/test_learned_memory",)),
    ("rocking/inner_mass.py", ("effects/test_learned_mode",)),
    ("rocking/hysteretic.py", ("effects/test_learned_hysteresis",)),
    ("rocking/effects/bouncing.py", ("effects/test_bouncing_contacts", *EFFECTS)),
    ("rocking/effects/*.py", EFFECTS),
    ("rocking/effect.py", EFFECTS),
    ("rocking/motion.py", ("test_trajectory", "effects/test_base_effects", *METHOD1)),
    ("rocking/scalars.py", (*METHOD1, *METHOD2)),
    (
        "rocking/solvers/exact/jax_flight.py",
        ("test_functions_of_exact_jax_flight", "test_functions_of_exact_jax_rounds", *DEVICES, *EXACT),
    ),
    (
        "rocking/solvers/exact/jax_lanes.py",
        ("test_functions_of_exact_jax_lanes", "test_functions_of_exact_jax_rounds", *DEVICES, *EXACT),
    ),
    ("rocking/solvers/exact/jax_rounds.py", ("test_functions_of_exact_jax_rounds", *DEVICES, *EXACT)),
    ("rocking/solvers/exact/jax*.py", (*DEVICES, *EXACT)),
    ("rocking/solvers/exact/step.py", ("test_functions_of_exact_step", "test_functions_of_exact_kernel", *EXACT)),
    ("rocking/solvers/exact/kernel.py", ("test_functions_of_exact_kernel", *EXACT)),
    ("rocking/solvers/exact/*.py", EXACT),
    (
        "rocking/solvers/piecewise/polynomial.py",
        (
            "test_functions_of_polynomial",
            "test_functions_of_exact_step",
            "test_functions_of_exact_kernel",
            *EXACT,
            *TAYLOR,
        ),
    ),
    ("rocking/solvers/piecewise/*.py", (*EXACT, *TAYLOR)),
    ("rocking/solvers/arrays.py", TAYLOR),
    (
        "rocking/solvers/taylor/flight.py",
        ("test_functions_of_taylor_flight", "test_functions_of_taylor_lanes", *TAYLOR),
    ),
    (
        "rocking/solvers/taylor/roots.py",
        ("test_functions_of_taylor_roots", "test_functions_of_taylor_lanes", *TAYLOR),
    ),
    ("rocking/solvers/taylor/lanes.py", ("test_functions_of_taylor_lanes", *TAYLOR)),
    ("rocking/solvers/taylor/turns.py", ("test_functions_of_taylor_turns", "test_functions_of_taylor_lanes", *TAYLOR)),
    ("rocking/solvers/taylor/waits.py", ("test_functions_of_taylor_turns", *TAYLOR)),
    (
        "rocking/solvers/taylor/table.py",
        ("test_functions_of_taylor_turns", "test_functions_of_taylor_lanes", *TAYLOR),
    ),
    ("rocking/solvers/taylor/log.py", ("test_functions_of_taylor_log", *TAYLOR)),
    ("rocking/solvers/taylor/*.py", TAYLOR),
    ("rocking/solvers/diffrax/runs.py", ("test_batch", *DIFFRAX)),
    ("rocking/solvers/diffrax/*.py", DIFFRAX),
    ("rocking/solvers/scipy_events.py", ("test_solvers_agree", "test_physics_under_jax", "test_trajectory")),
    ("rocking/solvers/numba/runge_kutta.py", ("test_functions_of_numba_runge_kutta", *NUMBA)),
    ("rocking/solvers/numba/kernel.py", ("test_functions_of_numba_kernel", *NUMBA)),
    ("rocking/solvers/*.py", NUMBA),
    ("dem/shapes.py", ("test_shapes", "test_stability")),
    ("dem/stability.py", ("test_stability", "test_drop")),
    ("dem/assembly_stability.py", ("test_assembly_contacts", "test_assembly_runs", "test_stability")),
    ("dem/materials.py", ("test_shapes", "test_inputs", "test_assembly_contacts", *ONE_BODY)),
    ("dem/drop.py", ("test_drop", "test_preliminary")),
    ("dem/free_swings.py", ("test_preliminary", "test_restitution")),
    ("dem/history.py", ("test_history", "test_preliminary", *ONE_BODY)),
    ("dem/step.py", ONE_BODY),
    ("dem/simulate.py", ("test_history", *ONE_BODY)),
    ("dem/contact_law.py", (*ONE_BODY, *CONTACTS)),
    ("dem/table_motion.py", ("test_assembly_records", "test_friction", "test_assembly_runs")),
    ("dem/barrier.py", ("test_assembly_runs", "test_inputs", "test_assembly_contacts")),
    ("dem/assembly_history.py", ("test_assembly_runs", "test_assembly_records")),
    ("dem/scenes*.py", ("test_assembly_runs", "test_shapes", "test_assembly_contacts")),
    ("dem/*.py", CONTACTS),
    ("excitation/pulse*.py", PULSES),
    ("excitation/ramped_sinusoid.py", ("test_ramped_sinusoid", *SINES)),
    ("excitation/*sin*.py", SINES),
    ("excitation/chirp.py", SINES),
    ("excitation/pitch*.py", ("test_pitch", "test_motion_contract")),
    ("excitation/sampled.py", ("test_sampled", "test_motion_contract")),
    ("excitation/jumps.py", ("test_sampled",)),
    ("excitation/splines.py", ("test_sampled", "test_processing")),
    ("excitation/combined.py", ("test_motion_contract", "test_pitch")),
    ("excitation/table.py", ("test_table",)),
    ("excitation/record.py", ("test_record", "test_processing")),
    ("excitation/kanai_tajimi.py", ("test_synthetic",)),
    ("excitation/point_source.py", ("test_synthetic",)),
    ("excitation/envelopes.py", ("test_ramped_sinusoid", "test_harmonic", "test_pitch", "test_motion_contract")),
    ("excitation/units.py", ("test_readers", "test_record")),
    ("excitation/rotation.py", ("test_processing", "test_record")),
    ("excitation/*.py", ("test_processing", "test_synthetic", "test_motion_contract")),
    *(
        (
            f"studies/laboratory/{name}.py",
            (
                f"laboratory/test_functions_of_laboratory_{name}",
                f"laboratory/test_laboratory_{name}",
                "laboratory/test_laboratory_campaigns",
            ),
        )
        for name in ("event", "slip", "contact")
    ),
    ("studies/laboratory/by_dem.py", ("laboratory/test_laboratory_by_dem",)),
    ("studies/laboratory/by_mujoco.py", ("laboratory/test_laboratory_by_mujoco",)),
    (
        "studies/laboratory/*.py",
        (
            "laboratory/test_laboratory_event",
            "laboratory/test_laboratory_instruments",
            "laboratory/test_laboratory_campaigns",
        ),
    ),
    ("studies/criteria/overturning.py", ("test_overturning", "test_fig16")),
    ("studies/criteria/free_vibration.py", ("test_free_vibration", "test_fig16")),
    ("studies/fig0*", ("test_preliminary_figures",)),
    ("studies/families/numerical_stability.py", ("test_preliminary_figures",)),
    ("studies/criteria/columns.py", ("test_columns", "test_contact_judgement")),
    ("studies/criteria/rocking_onset.py", ("test_columns", "test_all_studies")),
    ("studies/criteria/pickups.py", ("test_columns",)),
    ("studies/will_it_fall.py", ("test_will_it_fall",)),
    ("studies/dead_reckoning.py", ("test_dead_reckoning",)),
    ("studies/specimens.py", ("test_specimens",)),
    ("studies/slenderness.py", ("test_slenderness",)),
    ("studies/*.py", ("test_all_studies",)),
)
SOLVERS = {"diffrax", "exact", "numba", "taylor"}
OF_ALL_SOLVERS = {"tests/rocking/test_solvers_agree.py", "tests/rocking/test_other_engines.py"}
# Tests that say nothing about physics, or that look at the tree as a whole.
NOT_RUN = {"test_all_files", "test_numba_cache", "test_cache", "test_import_is_light", "test_bad_campaigns"}


def files(root: Path) -> list[Path]:
    """All files of physics, in order, relative to the root."""
    found = [path for folder in FOLDERS for path in sorted(root.glob(f"{folder}/*.py")) if path.name not in LEFT_OUT]
    found = [path for path in found if path != root / "studies/laboratory/effects.py"]  # sizes of what is drawn by lot
    found += [root / "studies" / f"{name}.py" for name in STUDIES]
    return sorted(dict.fromkeys(path.relative_to(root) for path in found))


def first_tests(root: Path, file: str) -> list[str]:
    """Tests of the file's own name, and those that the table names for it, as far as they are there."""
    folder = Path("tests") / Path(file).parts[0]
    names = next((tests for pattern, tests in FIRST if fnmatch(file, pattern)), ())
    own = sorted(path.relative_to(root) for path in (root / folder).rglob(f"test_{Path(file).stem}.py"))
    paths = [*own, *(folder / f"{name}.py" for name in names)]
    return [str(path) for path in dict.fromkeys(paths) if (root / path).is_file()]


def groups(root: Path, file: str) -> list[list[str]]:
    """What pytest is given for a file, one call after the other: tests of the table, then the rest of the package's."""
    package, stem = Path(file).parts[0], Path(file).stem
    first = first_tests(root, file)
    rest = sorted(str(path.relative_to(root)) for path in (root / "tests" / package).rglob("test_*.py"))
    if package != "studies":
        own = Path(file).parent.name
        agreed = [path for path in first if path in OF_ALL_SOLVERS and own in SOLVERS]
        named = [path for path in rest if stem in (root / path).read_text()]
        rest = [path for path in dict.fromkeys([*named, *rest]) if path not in first]
        # Of the tests of all solvers those of another one see nothing, and take long.
        parts = [[p for p in first if p not in agreed], [*agreed, "-k", own] if agreed else [], _kept(rest)]
        return [part for part in parts if part]
    # The loop, sweeps, animations and campaigns have no physics in these files, and of the quick studies only those
    # that use a file can see it.
    every = "tests/studies/test_all_studies.py"
    commands = {p.stem: [p] for p in (root / "studies").glob("*.py")}
    commands |= {p.parent.name: sorted(p.parent.glob("*.py")) for p in (root / "studies").glob("*/__main__.py")}
    users = [name for name in sorted(commands) if any(_uses(p.read_text(), stem) for p in commands[name])]
    kept = [path for path in rest if path.startswith(("tests/studies/test_", "tests/studies/laboratory/"))]
    parts = [
        [path for path in first if path != every],
        [every, "-k", " or ".join([stem, *users])],
        _kept(path for path in kept if path not in (*first, every)),
    ]
    return [part for part in parts if part]


def _kept(paths: Iterable[str]) -> list[str]:
    return [path for path in paths if Path(path).stem not in NOT_RUN]


def _uses(text: str, stem: str) -> bool:
    return f".{stem} import" in text or f"import {stem}" in text
