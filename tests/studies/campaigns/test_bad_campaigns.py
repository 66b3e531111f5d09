"""Everything that can be wrong with a campaign ends in one sentence that says where and what was wanted."""

import gzip
import os
import re

import numpy as np
import pytest

from studies.campaigns import CampaignError, read
from studies.campaigns import records as records_module


def replaced(name, old, new, count=1):
    """Replace text in a file of the campaign, which has to be there."""

    def change(folder):
        path = folder / name
        data = path.read_bytes()
        assert old.encode() in data, (name, old)
        path.write_bytes(data.replace(old.encode(), new if isinstance(new, bytes) else new.encode(), count))

    return change


def toml(old, new, count=1):
    return replaced("campaign.toml", old, new, count)


def written(name, data):
    return lambda folder: (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())


def lines(name, change):
    """Change the list of lines of a record."""

    def edit(folder):
        path = folder / name
        path.write_text("\n".join(change(path.read_text(encoding="utf-8").split("\n"))), encoding="utf-8")

    return edit


def columns(name, **changes):
    """Change columns of a record as arrays."""

    def edit(folder):
        path = folder / name
        header, *rows = path.read_text(encoding="utf-8").strip().split("\n")
        names = header.split(",")
        table = np.array([[float(v or "nan") for v in row.split(",")] for row in rows])
        for column, change in changes.items():
            table[:, names.index(column)] = change(table[:, names.index(column)])
        text = [",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in table]
        path.write_text("\n".join([header, *text]), encoding="utf-8")

    return edit


def all_of(*changes):
    return lambda folder: [change(folder) for change in changes]


def every_forced(**changes):
    return all_of(*(columns(name, **changes) for name in ("ramp-3Hz.csv", "ramp-4Hz.csv", "named é.csv")))


def data_of_free(path):
    return toml('data = "free-01.csv"', f"data = {path}")


def id_of_free(id):
    return toml('id = "free-01"', f"id = {id}")


def missing(*names):
    return lambda folder: [(folder / name).unlink() for name in names]


def linked(folder):
    outside = folder.parent.parent / f"outside-{folder.parent.name}.csv"
    outside.write_bytes((folder / "free-01.csv").read_bytes())
    (folder / "free-01.csv").unlink()
    (folder / "free-01.csv").symlink_to(outside)


def piped(folder):
    (folder / "free-01.csv").unlink()
    os.mkfifo(folder / "free-01.csv")


FREE = "free-01.csv"
RAMP = "ramp-3Hz.csv"

CASES = {
    # campaign.toml as a file
    "no campaign.toml": (missing("campaign.toml"), r"made'?: is not there|campaign.toml"),
    "empty campaign.toml": (written("campaign.toml", ""), "block is missing, want a table"),
    "no TOML": (written("campaign.toml", "title = \n"), "is not TOML: .*line 1"),
    "a CSV for a TOML": (written("campaign.toml", "time,rotation\n0,1\n"), "is not TOML"),
    "UTF-16": (written("campaign.toml", "title".encode("utf-16")), "is in UTF-16, want UTF-8"),
    "Latin-1": (toml("é", b"\xe9"), "campaign.toml, line 1: is not in UTF-8"),
    "nested a thousandfold": (written("campaign.toml", "a = " + "[" * 50_000), "nested too deeply"),
    "a number of 5000 digits": (toml("breadth = 0.15", "breadth = " + "9" * 5000), "is not TOML"),
    "a number beyond doubles": (toml("breadth = 0.15", "breadth = 1" + "0" * 400), "breadth=.*want a positive number"),
    "too large": (written("campaign.toml", b"#" * 3_000_000), "more than 2097152 bytes"),
    "title is a number": (toml("title = ", "title = 1 #"), "title=1, want text"),
    # block and conditions
    "no block": (toml("[block]", "[blocks]"), "found the key 'blocks', want block"),
    "block is a number": (lambda f: written("campaign.toml", "block = 3\n")(f), r"block=3, want a table \[block\]"),
    "no breadth": (toml("breadth = 0.15\n", ""), r"\[block\]: breadth is missing, want a positive number \(m\)"),
    "no mass": (toml("mass = ", "weight = "), r"mass is missing"),
    "a slip in a key": (toml("height = 0.5", "hieght = 0.5"), "found the key 'hieght', want height"),
    "negative breadth": (toml("breadth = 0.15", "breadth = -0.15"), "breadth=-0.15, want a positive number"),
    "breadth is text": (toml("breadth = 0.15", 'breadth = "0.15"'), "breadth='0.15', want a positive number"),
    "breadth is true": (toml("breadth = 0.15", "breadth = true"), "breadth=True, want a positive"),
    "breadth is infinite": (toml("breadth = 0.15", "breadth = inf"), "breadth=inf, want a positive"),
    "breadth is nan": (toml("breadth = 0.15", "breadth = nan"), "breadth=nan, want a positive"),
    "block in mm": (
        all_of(
            *(toml(f"{k} = {v}", f"{k} = {1000 * v}") for k, v in (("breadth", 0.15), ("height", 0.5), ("depth", 0.25)))
        ),
        r"density of 6e-07 kg/m\^3, want sizes in m",
    ),
    "one size in mm": (toml("breadth = 0.15", "breadth = 150.0"), "150, 0.5 and 0.25, want all three in m"),
    "mass in g": (toml("mass = 11.25", "mass = 11250.0"), r"density of 6e\+05 .*mass in kg"),
    "mass in t": (toml("mass = 11.25", "mass = 0.01125"), "density of 0.6 "),
    "centre of mass in mm": (
        toml("mass = 11.25", "mass = 11.25\ncentre_of_mass_height = 250.0"),
        "centre_of_mass_height=250.0, want a positive number up to 0.5 .m, inside the block",
    ),
    "inertia in kg cm^2": (toml("mass = 11.25", "mass = 11.25\ninertia = 2600.0"), "radius of gyration .* want kg m"),
    "negative inertia": (toml("mass = 11.25", "mass = 11.25\ninertia = -0.2"), "inertia=-0.2, want a positive"),
    "restitution above one": (toml("restitution = 0.93", "restitution = 1.3"), "restitution=1.3, want .* up to 1 "),
    "negative friction": (toml("friction = 0.7", "friction = -0.7"), "friction=-0.7, want a positive"),
    "conditions are a list": (toml("[conditions]", "[[conditions]]"), r"conditions=a list, want a table"),
    # channels
    "no channels": (
        toml("[[channel]]", "[[unused]]", 9),
        r"channel is missing, want one table \[\[channel\]\] or more",
    ),
    "channel is one table": (
        written("campaign.toml", "[block]\nbreadth=1\nheight=1\ndepth=1\nmass=900\n[channel]\n"),
        r"channel=a table, want one table \[\[channel\]\]",
    ),
    "unknown kind of channel": (
        toml('kind = "rotation"', 'kind = "tilt"'),
        "kind='tilt', want one of rotation, base_acc",
    ),
    "kind is a list": (toml('kind = "rotation"', "kind = [1]"), "kind=a list, want one of"),
    "channel without a name": (
        toml('name = "rotation"\n', ""),
        "channel 1: name is missing, want the name of a column",
    ),
    "channel named time": (
        toml('name = "rotation"', 'name = "time"'),
        "name='time', want the name of a column other than",
    ),
    "channel named twice": (
        toml('name = "base_x"', 'name = "rotation"'),
        "channel 2: name='rotation', want each name once",
    ),
    "a name with a comma": (toml('name = "rotation"', 'name = "a,b"'), "without commas"),
    "negative noise": (
        toml("noise = 0.0002", "noise = -0.0002"),
        "channel 'rotation': noise=-0.0002, want a number from 0",
    ),
    "noise in another unit": (toml("noise = 0.0002", "noise = 0.2"), "noise=0.2 rad, but its largest reading is 0.19"),
    "noise in mm/s^2": (toml("noise = 0.004", "noise = 4.0"), r"noise=4 m/s\^2, but its largest reading"),
    "accelerometer nowhere": (
        toml("position = [\n    0.0,\n    0.48,\n]\n", ""),
        "'acc_top': position is missing, want two",
    ),
    "accelerometer without axis": (
        toml("direction = [\n    0.0,\n    1.0,\n]\n", ""),
        "direction is missing, want two",
    ),
    "axis without length": (
        toml("0.0,\n    1.0,", "0.0,\n    0.0,"),
        "direction=a list, want an axis that has a length",
    ),
    "axis of three numbers": (toml("0.0,\n    1.0,", "0.0,\n    1.0, 0.0,"), "direction=a list, want two numbers"),
    "position in mm": (toml("0.48,", "480.0,"), r"position=\[0, 480\] is far off the block, want metres"),
    "position of a rotation": (toml("noise = 0.0002", "position = [0.0, 0.0]"), "want it for block_acceleration alone"),
    # tests
    "no tests": (toml("[[test]]", "[[unused]]", 9), r"test is missing, want one table \[\[test\]\] or more"),
    "an empty list of tests": (
        written(
            "campaign.toml",
            "test = []\n[block]\nbreadth=1\nheight=1\ndepth=1\nmass=900\n[[channel]]\nname='r'\nkind='rotation'\n",
        ),
        "test=a list, want one table",
    ),
    "an id twice": (toml('id = "ramp-4Hz"', 'id = "ramp-3Hz"'), "test 3: id='ramp-3Hz', want each id once"),
    "id is a number": (id_of_free("7"), "test 1: id=7, want a name"),
    "id with a slash": (id_of_free('"../../etc/passwd"'), r"id='../../etc/passwd', want a name that can be a file's"),
    "id of dots": (id_of_free('".."'), r"id='..', want a name"),
    "empty id": (id_of_free('""'), "id='', want a name"),
    "id with a line break": (id_of_free('"a\\nb"'), r"id='a\\nb', want a name"),
    "id that turns the text round": (id_of_free('"a\\u202eb"'), r"id='a\\u202eb', want a name"),
    "overlong id": (id_of_free(f'"{"x" * 300}"'), r"id='x+\.\.\., want a name"),
    "unknown kind of test": (toml('kind = "free"', 'kind = "swung"'), "kind='swung', want free or forced"),
    "test without data": (toml('data = "free-01.csv"\n', ""), "'free-01': data is missing, want the name of a CSV"),
    "free without a lean": (toml("initial_rotation = 0.19\n", ""), "initial_rotation is missing, want the lean"),
    "free from upright": (toml("initial_rotation = 0.19", "initial_rotation = 0"), "initial_rotation=0, want the lean"),
    "lean in degrees": (
        toml("initial_rotation = 0.19", "initial_rotation = 10.9"),
        "initial_rotation=10.9, want .*rad",
    ),
    "lean in small degrees": (
        toml("initial_rotation = 0.19", "initial_rotation = 2.0"),
        "6.86 times the tilt of unstable",
    ),
    "lean to the other side": (toml("initial_rotation = 0.19", "initial_rotation = -0.19"), "begins at 0.19.* in sign"),
    "overturned is text": (toml("overturned = false", 'overturned = "no"'), "overturned='no', want true or false"),
    "motion is a number": (toml('motion = "ramp x 1.4"', "motion = 3"), "motion=3, want the name of a motion"),
    # paths
    "absolute path": (data_of_free('"/etc/passwd"'), "data='/etc/passwd', want a relative path"),
    "path two up": (data_of_free('"../../x.csv"'), "want a relative path"),
    "path up in the middle": (data_of_free('"a/../../x.csv"'), "want a relative path"),
    "path to the folder above": (data_of_free('".."'), "want a relative path"),
    "path with a drive": (data_of_free('"C:/x.csv"'), "want a relative path"),
    "path with backslashes": (data_of_free("'..\\x.csv'"), "want a relative path with forward slashes"),
    "path with a null": (data_of_free('"a\\u0000.csv"'), "want a relative path"),
    "path of home": (data_of_free('"~/x.csv"'), "want a relative path"),
    "empty path": (data_of_free('""'), "data='', want a relative path"),
    "overlong path": (data_of_free(f'"{"x" * 999}"'), "cannot be read"),
    "link out of the campaign": (linked, "leads out through a link"),
    "a folder for a record": (data_of_free('"."'), "want a relative path|no plain file"),
    "a pipe for a record": (piped, "free-01.csv: is no plain file"),
    "no record": (missing(FREE), r"free-01.csv: cannot be read \(No such file"),
    # records as text
    "empty record": (written(FREE, ""), "free-01.csv: is empty, want a header"),
    "header alone": (written(FREE, "time,rotation\n"), "has 0 samples, want 16 or more"),
    "too few samples": (lines(FREE, lambda x: x[:12]), "has 11 samples, want 16 or more"),
    "no header": (lines(FREE, lambda x: x[1:]), "line 1: found '0.0,.*want a header that starts with 'time'"),
    "comment first": (lines(FREE, lambda x: ["# made by", *x]), "line 1: found '# made by', want a header"),
    "semicolons": (lines(FREE, lambda x: [v.replace(",", ";") for v in x]), "want a header .*separated by commas"),
    "a column that is no channel": (
        lines(FREE, lambda x: ["time,theta", *x[1:]]),
        "found 'theta', want a column that is",
    ),
    "a column twice": (
        lines(FREE, lambda x: ["time,rotation,rotation", *x[1:]]),
        "found 'rotation', want each column once",
    ),
    "a column without a name": (lines(FREE, lambda x: ["time,", *x[1:]]), "found '', want a column that is a declared"),
    "a field too few": (lines(RAMP, lambda x: [*x[:9], x[9].rsplit(",", 1)[0], *x[10:]]), "line 10: .* want 3 fields"),
    "a field too many": (lines(RAMP, lambda x: [*x[:9], x[9] + ",1", *x[10:]]), "line 10: .* want 3 fields"),
    "a blank line": (lines(FREE, lambda x: [*x[:5], "", *x[5:]]), "line 6: found '', want a line of numbers"),
    "a comment in between": (lines(FREE, lambda x: [*x[:5], "# here, we", *x[5:]]), "line 6: .*want finite numbers"),
    "a word": (lines(FREE, lambda x: [*x[:5], "0.016,n/a", *x[6:]]), "line 6: found '0.016,n/a', want finite numbers"),
    "letters of a number": (lines(FREE, lambda x: [*x[:5], "0.016,na", *x[6:]]), "line 6: .*want finite numbers"),
    "infinite": (lines(FREE, lambda x: [*x[:5], "0.016,inf", *x[6:]]), "line 6: .*want finite numbers"),
    "too large for a double": (lines(FREE, lambda x: [*x[:5], "0.016,1e999", *x[6:]]), "line 6: .*want finite numbers"),
    "underscores": (lines(FREE, lambda x: [*x[:5], "0.016,1_0", *x[6:]]), "line 6: .*want finite numbers"),
    "decimal commas": (
        lines(FREE, lambda x: [x[0], *(v.replace(".", ",") for v in x[1:])]),
        "line 2: .*decimal points",
    ),
    "decimal commas in quotes": (
        lines(FREE, lambda x: [x[0], *('"' + v.replace(",", '","').replace(".", ",") + '"' for v in x[1:-1])]),
        "line 2: .*decimal points",
    ),
    "an unclosed quote": (lines(FREE, lambda x: [*x[:5], '0.016,"0.1', *x[6:]]), "line 6: .*want finite numbers"),
    "Latin-1 in a record": (
        lambda f: (f / FREE).write_bytes(b"time,rotation\n" + b"0,\xe9\n" * 20),
        "line 2: is not in UTF",
    ),
    "UTF-16 record": (lambda f: (f / FREE).write_bytes("time".encode("utf-16")), "is in UTF-16"),
    "binary record": (lambda f: (f / FREE).write_bytes(bytes(range(128)) * 9), "line 1: .*want a header"),
    "cut gzip": (lambda f: (f / FREE).write_bytes(gzip.compress((f / FREE).read_bytes())[:-20]), "damaged gzip file"),
    "gzip header alone": (written(FREE, b"\x1f\x8b\x08\x00"), "damaged gzip file"),
    "gzip with a wrong sum": (
        lambda f: (f / FREE).write_bytes(gzip.compress(b"time\n" * 99)[:-8] + b"12345678"),
        "damaged gzip file",
    ),
    # times
    "a time is missing": (lines(FREE, lambda x: [*x[:5], ",0.1", *x[6:]]), "line 6: found 'no time', want a time"),
    "time goes back": (
        lines(FREE, lambda x: [*x[:9], x[3], *x[10:]]),
        "line 10: found '0.008', want a time after 0.028 s",
    ),
    "a time twice": (lines(FREE, lambda x: [*x[:9], x[8], *x[9:]]), "line 10: .*want a time after 0.028"),
    "a line left out": (lines(FREE, lambda x: [*x[:9], *x[10:]]), "line 10: found '0.036', want 0.032 s as the time"),
    "the clock changes": (
        columns(FREE, time=lambda t: np.where(t > 1, 1 + 2 * (t - 1), t)),
        "as the time, in equal steps",
    ),
    "time in ms": (columns(FREE, time=lambda t: 1000 * t), "a sample every 4 s, want steps of .*times in seconds"),
    "time in us": (columns(FREE, time=lambda t: t / 1e6), "a sample every 4e-09 s, want"),
    # what the numbers say
    "all rotations missing": (
        columns(FREE, rotation=lambda v: v * np.nan),
        "all samples of 'rotation' are missing, want",
    ),
    "all of the base missing": (
        columns("ahead.csv", base_x=lambda v: v * np.nan),
        "all samples of 'base_x' are missing",
    ),
    "forced without a base": (
        written("ahead.csv", "time\n" + "\n".join(f"{k / 100}" for k in range(99))),
        "'ahead': 'ahead.csv' has no column of kind base_acceleration_x",
    ),
    "rotation in degrees": (columns(FREE, rotation=np.rad2deg), "line 3: 'rotation' reads 10.8943, want radians"),
    "rotation in mrad": (columns(RAMP, rotation=lambda v: 1000 * v), "'rotation' reads .*want radians"),
    "rotation of one free test in mrad of a degree": (columns(FREE, rotation=lambda v: v / 1000), "begins at 0.00019"),
    "small rotations in degrees": (every_forced(rotation=lambda v: 15 * v), "comes back from .*want radians"),
    "a spike beyond pi": (
        lines(FREE, lambda x: [*x[:5], "0.016,-3.2", *x[6:]]),
        "line 6: 'rotation' reads -3.2, want rad",
    ),
    "base in mm/s^2": (every_forced(base_x=lambda v: 1000 * v), r"'base_x' reads .*want m/s\^2 \(at most 500\)"),
    "base in g": (every_forced(base_x=lambda v: v / 9.80665), r"want base accelerations in m/s\^2"),
    "base at rest": (every_forced(base_x=lambda v: 0 * v), r"rocking takes, want base accelerations in m/s\^2"),
    "sensor in g": (
        columns("ramp-4Hz.csv", acc_top=lambda v: v / 9.80665),
        "'acc_top' mostly reads 0.97.*want about 9.8",
    ),
    "sensor without gravity": (columns("ramp-4Hz.csv", acc_top=lambda v: v - 9.80665), "gravity included"),
    "sensor upside down": (columns("ramp-4Hz.csv", acc_top=lambda v: -v), "mostly reads -9.5.* want about 9.8"),
    "sensor in mm/s^2": (columns("ramp-4Hz.csv", acc_top=lambda v: 1000 * v), "mostly reads 9518, want m/s"),
    "rotation with the wrong sign": (
        every_forced(rotation=lambda v: -v),
        "'ramp-3Hz', 'ramp-4Hz', 'named é': .*against the signs",
    ),
    "base with the wrong sign": (every_forced(base_x=lambda v: -v), "lean toward -x"),
    "one base with the wrong sign": (columns(RAMP, base_x=lambda v: -v), "test 'ramp-3Hz': the block rocks against"),
}


@pytest.mark.parametrize("case", CASES)
def test_is_answered_with_one_sentence(folder, case):
    change, wanted = CASES[case]
    change(folder)
    with pytest.raises(CampaignError) as caught:
        read(folder / "campaign.toml")
    sentence = str(caught.value)
    assert re.search(wanted, sentence), sentence
    assert "\n" not in sentence and len(sentence) < 400 and sentence.isprintable()


def test_half_of_a_base_is_odd_but_left_to_whoever_fits(folder):
    """A gain of two may be physics (a block on a narrow foot), not a slip of units."""
    every_forced(base_x=lambda v: 0.5 * v)(folder)
    read(folder)


def test_there_are_many_cases():
    assert len(CASES) >= 60


def test_a_vertical_base_with_gravity_in_it(campaign, folder):
    toml('kind = "block_acceleration"', 'kind = "base_acceleration_z" #')(folder)
    toml("position = [\n    0.0,\n    0.48,\n]\ndirection = [\n    0.0,\n    1.0,\n]\n", "")(folder)
    with pytest.raises(CampaignError, match=r"'acc_top' reads 9\..*without gravity"):
        read(folder)


def test_a_bomb_is_not_unpacked(folder, monkeypatch):
    """A limit of 1 MiB stands for the 64 MiB: 10 MB of zeros in 10 kB."""
    monkeypatch.setattr(records_module, "MAX_BYTES", 2**20)
    (folder / "free-01.csv").write_bytes(gzip.compress(b"time,rotation\n" + b"0" * 10_000_000))
    with pytest.raises(CampaignError, match="more than 1048576 bytes when unpacked"):
        read(folder)


def test_memory_of_a_bomb_is_bounded(folder):
    """1 GB of zeros in 1 MB: no more than a few times the limit is ever held."""
    import tracemalloc

    block = gzip.compress(b"0" * 2**24)
    (folder / "free-01.csv").write_bytes(block * 64)
    tracemalloc.start()
    with pytest.raises(CampaignError, match="when unpacked"):
        read(folder)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 4 * records_module.MAX_BYTES


def test_a_campaign_of_too_many_numbers(folder, monkeypatch):
    from studies.campaigns import reading

    monkeypatch.setattr(reading, "MAX_SAMPLES", 3000)
    with pytest.raises(CampaignError, match="more than 3000 numbers"):
        read(folder)
