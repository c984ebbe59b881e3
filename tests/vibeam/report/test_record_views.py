"""Views of motions under a record: packing and drawing of histories and impacts lose no extreme, in Python and node."""

import base64

import numpy as np
import pytest

from vibeam.observe import Exceedance, exceedance_of
from vibeam.report.page.record_charts import enclosing


@pytest.fixture
def bins():
    rng = np.random.default_rng(8)
    middle = np.cumsum(rng.standard_normal(999))
    return middle - rng.exponential(1e-3, 999), middle + rng.exponential(1.0, 999)


def test_a_packed_history_encloses_its_values_within_a_step(bins, node):
    least, greatest = bins
    stored = enclosing(least, greatest) | {"begin": -1.0, "width": 0.5}
    script = """
        const { inflated } = await load("report/page/base64.js"), { unfolded } = await load("report/page/envelope.js");
        const { least, greatest } = unfolded(given, await inflated(given.data, "deflate"));
        return [Array.from(least), Array.from(greatest)];
    """
    low, high = np.array(node(script, stored))
    step = stored["step"]
    assert step == pytest.approx((greatest.max() - least.min()) / 65535)
    rounding = 1e-9 * step
    assert np.all((low <= least + rounding) & (low > least - 1.001 * step))
    assert np.all((high >= greatest - rounding) & (high < greatest + 1.001 * step))
    assert len(base64.b64decode(stored["data"])) < 4 * len(least)


def test_a_constant_history_is_packed():
    stored = enclosing(np.full(7, 3.0), np.full(7, 3.0))
    assert (stored["low"], stored["step"], stored["bins"]) == (3.0, 0.0, 7)


DRAWN = """
    const { envelope, hits } = await load("report/page/envelope.js"), points = [], none = () => {};
    const pen = { moveTo: (x, y) => points.push([x, y]), lineTo: (x, y) => points.push([x, y]), beginPath: none,
      closePath: none, setLineDash: none, fill: none, stroke: none };
    const [low, high] = given.span, at = { ratio: 1, left: 0, top: 0, width: given.width, height: 100,
      x: (value) => (value - low) / (high - low) * given.width, y: (value) => value };
    const history = { begin: 0, width: given.bin, least: given.least, greatest: given.greatest };
    envelope(pen, at, history, given.span, { colour: "#000", wide: 1 });
    return [points, hits({ time: given.time, velocity: given.velocity }, given.span, given.width)];
"""


@pytest.mark.parametrize(("span", "width"), [((0.0, 999.0), 40), ((100.2, 700.9), 300), ((500.1, 508.7), 400)])
def test_what_is_drawn_reaches_the_extremes_and_the_hardest_impact_of_the_window(bins, node, span, width):
    least, greatest = bins
    rng = np.random.default_rng(2)
    time, velocity = np.sort(rng.uniform(0, 999, 4000)), rng.exponential(1.0, 4000)
    given = {"span": span, "width": width, "bin": 1.0, "least": least, "greatest": greatest}
    points, (times, speeds) = node(DRAWN, given | {"time": time, "velocity": velocity})
    x, y = np.array(points).T
    inside = slice(int(span[0]), int(np.ceil(span[1])))
    shown = (x > -2 * width) & (x < 3 * width)
    assert y[shown].min() <= least[inside].min()
    assert y[shown].max() >= greatest[inside].max()
    assert len(points) < 12 * width
    seen = (time >= span[0]) & (time <= span[1])
    assert max(speeds, default=0.0) == velocity[seen].max(initial=0.0)
    assert len(times) <= min(width + 1, seen.sum())
    columns = np.floor((time[seen] - span[0]) / ((span[1] - span[0]) / width))
    assert sorted(speeds) == pytest.approx(sorted(max(velocity[seen][columns == each]) for each in np.unique(columns)))


def test_exceedance_counts_what_is_as_hard_or_harder():
    found = exceedance_of([np.array([3.0, 1.0]), np.array([2.0]), np.array([])], 2.0)
    assert found.velocity.tolist() == [1.0, 2.0, 3.0]
    assert found.rate.tolist() == pytest.approx([3 / 6, 2 / 6, 1 / 6])
    counts = np.array([[2, 1, 0], [1, 1, 0], [1, 0, 0]]) / 2
    assert found.error.tolist() == pytest.approx((counts.std(axis=1, ddof=1) / np.sqrt(3)).tolist())
    assert exceedance_of([], 1.0) == Exceedance(np.empty(0), np.zeros(0), np.empty(0))
    many = exceedance_of([np.arange(10_000.0)], 1.0, most=50)
    assert (len(many.velocity), many.velocity[-1], many.rate[-1]) == (50, 9999.0, 1.0)
    with pytest.raises(ValueError, match="duration"):
        exceedance_of([np.ones(1)], 0.0)
