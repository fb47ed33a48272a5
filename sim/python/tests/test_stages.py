"""Stage by stage against whole tiles, pictures and the exported vectors."""

import numpy as np
import pytest
import splatline
from splatline import FixedArray, Stages


@pytest.fixture(scope="module", params=["standard24", "lean18", "classic8"])
def stages(request, scene, camera):
    return Stages(scene, camera, request.param)


def test_stages_one_by_one_draw_the_picture(stages):
    """Setup, spans, radial index, weight, opacity and blend in NumPy's hands, against the tile and the engine's picture."""
    packets = stages.setup().sorted()
    columns, rows = stages.plan.camera.size
    pixels = stages.clear(rows, columns)
    for index in range(len(packets)):
        inside = stages.radial(packets.words[index])
        weight = stages.weight(inside["radial"])
        opacity = stages.opacity(packets["peak"].raw[index], weight)
        colour = [packets[name].raw[index] for name in ("red", "green", "blue")]
        place = inside["row"].raw, inside["column"].raw
        pixels[place] = stages.blend(pixels[place], opacity, colour)
    assert (pixels == stages.tile(packets.words)).all()
    assert (stages.rgba(pixels) == splatline.render(stages.plan).rgba).all()


def test_a_window_is_a_part_of_the_picture(stages):
    words = stages.setup().sorted().words
    whole, part = stages.tile(words), stages.tile(words, (8, 16, 40, 48))
    assert (part == whole[16:48, 8:40]).all()


def test_radial_indices_are_the_spans_differences(stages):
    packets = stages.setup().sorted()
    for words in packets.words[:50]:
        spans, inside = stages.spans(words), stages.radial(words)
        bits = stages.widths["radial"]
        found = []
        for row, column, length, radial, first, second in spans.raw.tolist():
            for x in range(column, column + length):
                # Rounded to the nearest of UQ4.radial, as the lane drops the bits below.
                drop = spans.fields["radial"].fraction - bits
                value = radial + (1 << drop - 1) >> drop if drop > 0 else radial
                found.append((row, x, max(value, 0)))
                radial, first = radial + first, first + second
        known = {(row, x): value for row, x, value in found}
        assert all(known[row, x] == value for row, x, value in inside.raw.tolist())


def test_fields_of_packets_are_those_of_the_vectors(stages):
    vectors = stages.vectors(64)["packets"]
    packets = stages.setup(vectors["splat"].raw)
    for name in packets.fields:
        assert (packets[name] == vectors[name]).all(), name
    assert (packets.depth == vectors["depth"].raw).all()
    assert [field.offset for field in packets.fields.values()] == [vectors.fields[name].offset for name in packets.fields]


def test_packets_survive_bytes(stages):
    packets = stages.setup().sorted()
    again = stages.packets(packets.to_bytes())
    assert (again.words == packets.words).all()
    assert packets.to_int(0) & 0xFFFFFFFF == packets.words[0, 0]
    with pytest.raises(splatline.Error, match="words of 32 bits"):
        stages.tile(packets.words[:, :-1])
    with pytest.raises(splatline.Error, match="version"):
        stages.tile(np.zeros((1, stages.packet_words), np.uint32))


def test_vectors_end_in_the_tile(stages):
    vectors = stages.vectors(40)
    packets = stages.setup(vectors["packets"]["splat"].raw)
    tile = stages.tile(packets.words).reshape(-1, 4)
    assert (vectors["tile"]["red"].raw == tile[:, 0]).all()
    assert (vectors["tile"]["finished"].raw == tile[:, 3] >> 31).all()
    assert (vectors["table"]["entry"].raw == stages.table.raw).all()


def test_fixed_arrays_know_their_format():
    values = FixedArray([1, -2, 3], bits=8, fraction=2, signed=True)
    assert values.q == "Q5.2" and (values.to_numpy() == [0.25, -0.5, 0.75]).all()
    assert repr(values).startswith("FixedArray(Q5.2, [")
    assert (values == FixedArray([1, 0, 3], 8, 2, True)).tolist() == [True, False, True]
    assert FixedArray.from_numpy([0.3, 0.375], 4, 2).raw.tolist() == [1, 2]
    assert values[1:].raw.tolist() == [-2, 3] and len(values) == 3 and values.shape == (3,)
    assert (np.asarray(values) == values.to_numpy()).all()
    with pytest.raises(ValueError, match="beyond UQ2.2: allowed are 0 to 15"):
        FixedArray([16], 4, 2)
    with pytest.raises(ValueError, match="different units"):
        _ = values == FixedArray([1, 2, 3], 8, 3)
    with pytest.raises(TypeError, match="must hold integers"):
        FixedArray([0.5], 4)
    assert FixedArray.from_numpy([2.0**63], 64).raw.tolist() == [1 << 63]
    for beyond in (np.nan, np.inf, 1e30, 2.0**63, -(2.0**64)):
        with pytest.raises(ValueError, match="or beyond 64 bits"):
            FixedArray.from_numpy([beyond], 64, 0, True)


def test_apytypes_holds_the_same_numbers():
    pytest.importorskip("apytypes")
    values = FixedArray([1, -2, 3], bits=8, fraction=2, signed=True).to_apytypes()
    assert values.to_numpy().tolist() == [0.25, -0.5, 0.75]
