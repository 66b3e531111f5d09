"""The page, run in a browser without a display: it plays, scrubs, listens to keys, and shows bodies where they are."""

import math
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from studies.animation import film_of, save
from studies.animation.page import LEVELS, MOST_BYTES, MOST_FRAMES, page, thinned

# What the page shows, and what a hand on it does, for the scripts below.
HELP = """
const at = (id) => document.getElementById(id);
const shown = () => ({
  clock: Number(at("clock").textContent.slice(0, -2)), frame: Number(at("scrub").value),
  button: at("play").getAttribute("aria-label"),
  places: [...at("places").rows].map((row) => [...row.cells].slice(1).map((cell) => cell.textContent)),
  legend: [...at("legend").children].map((item) => item.querySelector("span").textContent.trim()),
});
const scrub = (frame) => { at("scrub").value = frame; at("scrub").dispatchEvent(new Event("input")); };
const spot = (x, z) => {  // of a place [m] in the window
  const box = at("scene").getBoundingClientRect(), [x0, x1, z0, z1] = JSON.parse(at("run").textContent).view;
  const k = Math.min(box.width / (x1 - x0), box.height / (z1 - z0));
  return [box.left + 0.5 * box.width + k * (x - 0.5 * (x0 + x1)), box.bottom - k * (z - z0)];
};
const colour = (x, z) => {
  const [px, py] = spot(x, z), box = at("scene").getBoundingClientRect();
  return [...at("scene").getContext("2d").getImageData(px - box.left, py - box.top, 1, 1).data];
};
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
"""


class Shown:
    """A page that is open in the browser."""

    def __init__(self, browser, path, text, size=(1200, 900), fragment=""):
        self.browser = browser
        path.write_text(text, encoding="utf-8")
        browser.open(path.as_uri() + fragment, *size)

    def run(self, script):
        found = self.browser.run(HELP + script)
        assert self.browser.errors == []
        return found

    @property
    def now(self):
        return self.run("return shown();")


@pytest.fixture
def show(browser, tmp_path):
    def opened(text, **arguments):
        return Shown(browser, tmp_path / "page.html", text, **arguments)

    return opened


def numbers(row):
    return [float(text.replace("\N{MINUS SIGN}", "-")) for text in row]


def half_a_level(values):
    """Largest error of a pose in the page."""
    return 0.5 * np.ptp(values) / LEVELS


def test_scrubbing_moves_each_body_to_the_place_that_the_dataset_says(column, show):
    film, opened = film_of(column), show(page(film_of(column)))
    places = []
    for frame in (0, film.time.size // 3, film.time.size - 1):
        shown = opened.run(f"scrub({frame}); return shown();")
        assert shown["clock"] == pytest.approx(film.time[frame], abs=5e-4)
        for b, row in enumerate(shown["places"]):
            x, z, degrees = numbers(row)
            # Half of a level of a coordinate, and half of the last digit shown.
            assert x == pytest.approx(film.x[frame, b], abs=half_a_level(film.x) + 6e-6)
            assert z == pytest.approx(film.z[frame, b], abs=half_a_level(film.z) + 6e-6)
            assert math.radians(degrees) == pytest.approx(film.theta[frame, b], abs=half_a_level(film.theta) + 1e-6)
        places.append(shown["places"])
    assert places[0] != places[1] != places[2]


def test_the_canvas_is_painted_where_the_bodies_are(column, show):
    film, opened = film_of(column), show(page(film_of(column)))
    last = film.time.size - 1
    there, then = ([float(film.x[i, 2]), float(film.z[i, 2])] for i in (0, last))
    green = [0x00, 0x9E, 0x73, 255]  # the third fill
    assert opened.run(f"scrub(0); return colour(...{there});") == green
    assert opened.run(f"scrub({last}); return colour(...{then});") == green
    # Where its centroid was, the fallen block is no more.
    assert opened.run(f"return colour({there[0]}, {there[1] + 0.2});") != green


def test_play_advances_in_real_time_and_stops_at_the_end(column, show):
    film, opened = film_of(column), show(page(film_of(column)))
    playing = """
      const from = shown().clock, begun = performance.now(); await wait(1200);
      return [shown().clock - from, (performance.now() - begun) / 1000, shown().button];
    """
    opened.run('at("play").click(); await wait(200);')
    # A busy machine may hold a frame back for a while: the clock is right whenever none is.
    tried = [opened.run(playing) for _ in range(3)]
    assert {button for *_, button in tried} == {"Stop"}
    assert min(abs(advanced - passed) for advanced, passed, _ in tried) < 0.2
    opened.run('at("speed").value = "0.1";')
    advanced, passed, _ = opened.run(playing)
    assert advanced == pytest.approx(0.1 * passed, abs=0.05)
    stopped = opened.run('at("play").click(); return shown();')
    assert opened.run("await wait(200); return shown();") == stopped and stopped["button"] == "Play"
    opened.run(f'at("speed").value = "1"; scrub({film.time.size - 5}); at("play").click(); await wait(700);')
    assert opened.now["clock"] == pytest.approx(film.time[-1], abs=5e-4) and opened.now["button"] == "Play"


def test_keys_step_play_and_change_the_speed(column, show):
    film, opened = film_of(column), show(page(film_of(column)))
    press = opened.browser.press
    for key, frame in (("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", film.time.size - 1)):
        press(key)
        assert opened.now["frame"] == frame
    press("Home")
    press("ArrowRight", shift=True)
    assert opened.now["clock"] == pytest.approx(1.0, abs=1e-3)
    press("+")
    assert opened.run('return at("speed").value;') == "2"
    press(" ")
    assert opened.run("await wait(500); return shown();")["clock"] > 1.2
    press(" ")
    assert opened.now["button"] == "Play"


def test_events_are_buttons_that_go_there(column, show):
    film, opened = film_of(column), show(page(film_of(column)))
    opened.run('[...document.querySelectorAll(".events button")].at(-1).click();')
    assert opened.now["clock"] == pytest.approx(film.events[-1][0], abs=1e-3)


def test_a_link_opens_at_its_instant_and_a_click_on_a_body_hides_its_trace(column, show):
    film, opened = film_of(column), show(page(film_of(column)), fragment="#t=0.5")
    assert opened.now["clock"] == 0.5 and opened.now["legend"] == list(film.names)
    opened.browser.click(*opened.run(f"return spot({film.x[0, 0]}, {film.z[0, 0]});"))
    assert opened.now["legend"] == list(film.names[1:])


def test_a_press_in_a_history_goes_to_its_instant(column, show):
    opened = show(page(film_of(column)))
    before = opened.now["clock"]
    box = opened.run("const b = at('rotation').getBoundingClientRect(); return [b.left, b.top, b.width, b.height];")
    opened.browser.click(box[0] + 46 + 0.5 * (box[2] - 52), box[1] + 0.4 * box[3])
    assert before == 0.0
    assert opened.now["clock"] == pytest.approx(0.5 * column.time[-1], rel=0.02)


@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_wider_than_the_window(column, show, width):
    opened = show(page(film_of(column)), size=(width, 900))
    assert opened.run("return document.documentElement.scrollWidth;") <= width
    columns = "return getComputedStyle(document.querySelector('main')).gridTemplateColumns.split(' ').length;"
    assert opened.run(columns) == (2 if width > 1000 else 1)


EVIL = "</script><script>document.title = 'names are run'</script><img src=x onerror=alert(1)>&'\""


def test_names_are_shown_as_they_are_and_never_run(column, show):
    film = replace(film_of(column), names=(EVIL, "a", "b"), title=EVIL, ending=EVIL, events=((0.1, EVIL),))
    opened = show(page(film))
    heading, name, images, title = opened.run(
        "return [document.querySelector('h1').textContent, at('places').rows[0].cells[0].textContent, "
        "document.images.length, document.title];"
    )
    assert heading == name == EVIL and images == 0 and title == EVIL + ": animation"
    assert opened.now["legend"][0] == EVIL


class Addresses(HTMLParser):
    """Everything that a page would fetch."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attributes):
        self.found += [value for name, value in attributes if name in ("src", "href", "srcset", "action", "data")]
        self.found += [tag] * (tag in ("link", "iframe", "object", "embed", "img"))


def test_the_page_names_no_other_address(column):
    text = page(film_of(column))
    parser = Addresses()
    parser.feed(text)
    assert parser.found == []
    assert "default-src 'none'" in text and "url(" not in text and "@import" not in text


def test_the_page_fetches_nothing(column, show):
    opened = show(page(film_of(column)))
    opened.run("at('play').click(); await wait(300);")
    assert all(address.startswith("file:") and address.endswith("page.html") for address in opened.browser.asked_for)


@pytest.mark.parametrize("samples", [10, 6000, 6001, 50_000])
@pytest.mark.parametrize("bodies", [1, 105, 1008])
def test_size_is_bounded_by_thinning_evenly(column, samples, bodies):
    film = film_of(column)
    still = np.zeros((samples, bodies))
    long = replace(
        film, time=np.arange(samples, dtype=float), x=still, z=still, theta=still, names=("x",) * bodies,
        outlines=film.outlines[:1] * bodies,
    )  # fmt: skip
    kept, every = thinned(long)
    assert len(kept) <= MOST_FRAMES + 1 and 6 * bodies * (len(kept) - 1) <= MOST_BYTES
    assert kept[0] == 0 and kept[-1] == samples - 1 and set(np.diff(kept[:-1])) <= {every}
    if samples <= MOST_FRAMES and 6 * bodies * samples <= MOST_BYTES:
        assert len(kept) == samples


def test_what_was_thinned_is_said(column):
    film = film_of(column)
    assert f"all {film.time.size} samples" in page(film)
    assert f"one in {math.ceil(film.time.size / 100)} of {film.time.size} samples" in page(film, most_frames=100)


def test_a_single_block_is_played_too(block, show, tmp_path):
    save(block, tmp_path / "block.html")
    opened = show((tmp_path / "block.html").read_text(encoding="utf-8"))
    opened.browser.press("End")
    assert numbers(opened.now["places"][0]) == pytest.approx(
        [block.x[-1], block.z[-1], math.degrees(block.theta[-1])], abs=2e-3
    )


def test_a_wall_of_a_hundred_blocks_is_played(show):
    import dem

    run = dem.simulate_assembly(
        dem.running_bond(10, 10), t_end=0.05, contact=dem.Contact(0.7, damping_ratio=0.3), save_every=200
    )
    opened = show(page(film_of(run)), size=(400, 800))
    opened.browser.press("End")
    assert len(opened.now["legend"]) == 6 and len(opened.now["places"]) == 105
