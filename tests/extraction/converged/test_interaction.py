"""What a change does to its neighbours, without a visit of the visibilities and with one.

Errors are those of a neighbour's gradient: of its flux, shape and place, each in units of its own noise, over the
change's significance.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING, LONGEST, PROFILE, changed
from tests.reference import plane
from tests.skies import L_BAND, galaxies, random_baselines, vla
from uvshear.constants import ARCSEC
from uvshear.extraction.converged.beams import gather_beams
from uvshear.extraction.converged.interaction import END, FAR, START, Interaction, Source
from uvshear.extraction.converged.major_cycle import ModelledSky, gather_residuals
from uvshear.extraction.converged.plan import Wanted, plan_visit
from uvshear.imaging.bands import Band
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities
from uvshear.predict.rendering import smooth_step
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template

SKY = galaxies(
    np.array([0, 30, -110, 300, 700.0]) * ARCSEC + 0.003,
    np.array([0, 16, 100, 290, -400.0]) * ARCSEC - 0.001,
    np.array([1.0, 0.6, 0.4, 0.8, 0.5]),
    np.array([4.0, 3.2, 3.6, 4.5, 3.0]) * ARCSEC,
    np.array([0.3 - 0.2j, -0.4j, 0.1 + 0.3j, 0.0, -0.3]),
)
"""The first changes; the others are 34, 149, 417 and 806 arcsec away: the image ends between 280 and 527."""

CHANGES = {
    "flux": changed(SKY, 0, flux=1.3),
    "ellipticity": changed(SKY, 0, ellipticity=0.2 + 0.1j),
    "size": changed(SKY, 0, scale_length=5 * ARCSEC),
    "place": changed(SKY, 0, l=SKY.l[0] + 1.0 * ARCSEC, m=SKY.m[0] - 1.7 * ARCSEC),
}


@dataclass(frozen=True)
class Field:
    """Five galaxies, seen without noise, as they stand at a visit."""

    uvw: np.ndarray

    def __post_init__(self):
        rng = np.random.default_rng(3)
        vis = predict_visibilities(SKY, self.uvw, L_BAND, PROFILE)
        seen = Visibilities(self.uvw, L_BAND, vis, rng.uniform(0.5, 2, vis.shape))
        wanted = Wanted(SKY.l, SKY.m, np.full(5, 150 * ARCSEC), np.full(5, LONGEST))
        values = {"observation": VisibilitySet(vla("b")[1], (seen,))}
        values["plan"] = plan_visit(wanted, 0.0, LONGEST)
        for name, value in values.items():
            object.__setattr__(self, name, value)
        lm = np.column_stack([SKY.l, SKY.m])
        beams = gather_beams(
            self.observation,
            lm,
            (0.0, LONGEST),
            self.plan.pixel,
            Response.from_sky(SKY),
            GRIDDING,
        )
        object.__setattr__(self, "beams", beams)
        object.__setattr__(self, "before", self.residuals(SKY))

    def residuals(self, sky):
        model = ModelledSky(sky, np.full(5, 120 * ARCSEC), Response.from_sky(sky), PROFILE)
        return gather_residuals(self.observation, self.plan, model, GRIDDING)

    def interaction(self):
        return Interaction(self.plan, self.beams, PROFILE)

    def source(self, sky, k):
        offset = np.array([sky.l[k], sky.m[k]]) - self.plan.place[k] * self.plan.pixel
        e, size = complex(sky.ellipticity[k]), float(sky.scale_length[k])
        return Source(float(sky.flux[k]), tuple(offset), e, size)

    def seen_by(self, interaction, k):
        """What the interaction changes in a facet, centred on its source."""
        cutout = self.plan.cutouts[k]
        facet = np.zeros(len(cutout.uv), np.complex64)
        interaction.subtract_from(facet, k)
        return facet * cutout.recentring(tuple(self.plan.offset[k]))

    def gradient(self, facet, k):
        """Of the log likelihood of a source by its parameters, each in units of its error."""
        cutout = self.plan.cutouts[k]
        fit = GalaxyFit(
            float(SKY.flux[k]),
            np.zeros(2),
            complex(SKY.ellipticity[k]),
            float(SKY.scale_length[k]),
            1.0,
        )
        responses = Template(cutout.uv, PROFILE).responses(fit)
        norm = np.sum(self.beams.power(k, cutout) * np.abs(responses) ** 2, axis=1)
        return np.sum(np.real(responses * np.conj(facet)), axis=1) / np.sqrt(norm)

    def change_of_first(self, sky):
        """Change of the first galaxy's visibilities on the cells of its facet."""
        uv = self.plan.cutouts[0].uv
        offset = sky.l[0] - SKY.l[0], sky.m[0] - SKY.m[0]
        new = plane.galaxy(uv, sky.flux[0], offset, sky.ellipticity[0], sky.scale_length[0])
        old = plane.galaxy(uv, SKY.flux[0], (0, 0), SKY.ellipticity[0], SKY.scale_length[0])
        return new - old

    def significance(self, sky):
        power = self.beams.power(0, self.plan.cutouts[0])
        return float(np.sqrt(np.sum(power * np.abs(self.change_of_first(sky)) ** 2)))


@pytest.fixture(scope="module")
def field():
    return Field(vla("b", samples=6)[0])


@pytest.fixture(scope="module")
def with_core():
    """Nine baselines in ten are below 20 m: their plateau reaches over the whole field."""
    core = random_baselines(1500, 20.0, seed=5)
    return Field(np.concatenate([core, random_baselines(150, 1e4, seed=6)]))


def _after(field, sky):
    interaction = field.interaction()
    _, change = interaction.rendered(0, field.source(SKY, 0), field.source(sky, 0))
    interaction.add(0, change)
    interaction.change_flux(sky.flux - SKY.flux)
    return interaction


@pytest.fixture(scope="module", params=CHANGES)
def case(request, field):
    """A change, what the interaction makes of it and what a second visit finds."""
    sky = CHANGES[request.param]
    return field, sky, _after(field, sky), field.residuals(sky)


def test_neighbours_see_a_change_as_a_second_visit_finds_it(case):
    field, sky, interaction, after = case
    for k in (1, 2):
        got = field.gradient(field.seen_by(interaction, k), k)
        expected = field.gradient(after[k] - field.before[k], k)
        # measured 5e-4 of the change; not told at all: 0.05 to 0.15, and twice that with the wrong sign
        assert np.linalg.norm(expected) > 0.04 * field.significance(sky)
        assert np.linalg.norm(got - expected) < 2e-3 * field.significance(sky)
        # measured 0.2 to 0.9 per cent of what is seen
        assert np.linalg.norm(got - expected) < 0.02 * np.linalg.norm(expected)


def test_a_source_sees_its_own_change_as_a_second_visit_finds_it(case):
    field, _, interaction, after = case
    got = field.gradient(field.seen_by(interaction, 0), 0)
    expected = field.gradient(after[0] - field.before[0], 0)
    # measured 0.1, 0.2, 0.2 and 1 per cent: the baselines that coarse pixels lose
    assert np.linalg.norm(got - expected) < 0.02 * np.linalg.norm(expected)


def test_own_power_puts_back_what_the_image_takes_from_a_sources_own_facet(case):
    field, sky, interaction, _ = case
    taken = field.gradient(field.seen_by(interaction, 0), 0)
    put_back = field.gradient(interaction.own_power(0) * field.change_of_first(sky), 0)
    # measured 3e-4; the power of the whole beam in its place: 1e-3 to 1e-2
    assert np.linalg.norm(taken + put_back) < 6e-4 * np.linalg.norm(put_back)


def test_what_was_added_and_taken_back_leaves_nothing(field):
    sky = CHANGES["flux"]
    interaction = _after(field, sky)
    whole = np.linalg.norm(field.seen_by(interaction, 1))
    _, back = interaction.rendered(0, field.source(sky, 0), field.source(SKY, 0))
    interaction.add(0, back)
    interaction.change_flux(np.zeros(5))
    assert np.linalg.norm(field.seen_by(interaction, 1)) < 1e-5 * whole


def test_changes_of_several_sources_add_up(field):
    skies = [CHANGES["size"], changed(SKY, 2, flux=0.9)]
    apart, together = [], field.interaction()
    for k, sky in zip((0, 2), skies, strict=True):
        alone = field.interaction()
        _, change = alone.rendered(k, field.source(SKY, k), field.source(sky, k))
        alone.add(k, change)
        together.add(k, change)
        apart.append(field.seen_by(alone, 1))
    np.testing.assert_allclose(
        field.seen_by(together, 1), sum(apart), rtol=0, atol=1e-5 * np.abs(apart[0]).max()
    )


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_plateau_of_short_baselines_couples_fluxes_at_any_distance(with_core, k):
    """Where nine baselines in ten are short, beyond the end of the image and within it."""
    sky = CHANGES["flux"]
    interaction, after = _after(with_core, sky), with_core.residuals(sky)
    got = with_core.gradient(with_core.seen_by(interaction, k), k)[0]
    expected = with_core.gradient(after[k] - with_core.before[k], k)[0]
    assert abs(expected) > 0.3 * with_core.significance(sky)
    # measured 3e-3; the image alone, or the plateau alone: 0.5 to 1
    assert got == pytest.approx(expected, rel=0.01)


def test_far_couplings_are_the_part_of_the_plateau_that_the_image_does_not_hold(with_core):
    far = with_core.interaction().far.toarray()
    np.testing.assert_array_equal(far, far.T)
    np.testing.assert_array_equal(np.diag(far), 0)
    place = np.column_stack([SKY.l, SKY.m])
    pixel = 2 * with_core.plan.pixel
    for i, j in ((0, 1), (0, 2), (0, 3), (1, 4), (3, 4)):
        distance = np.hypot(*(place[j] - place[i]))
        held = float(smooth_step(np.array([distance]), START * pixel, END * pixel)[0])
        plateau = float(with_core.beams.plateau((place[j] - place[i])[None, :])[0])
        expected = plateau * (1 - held) if distance < FAR * END * pixel else 0.0
        assert far[i, j] == pytest.approx(expected, abs=1e-4 * float(with_core.beams.wide.max()))
    assert far[0, 1] == far[0, 2] == 0
    assert far[0, 3] > 0
    assert far[0, 4] > far[0, 3]  # half of it is in the image at 417 arcsec


def test_sources_farther_than_the_plateau_reaches_are_not_coupled(with_core):
    interaction = with_core.interaction()
    assert interaction.reach == pytest.approx(END * 2 * with_core.plan.pixel)
    place = np.column_stack([SKY.l, SKY.m])
    assert np.hypot(*(place[3] - place[4])) < FAR * interaction.reach
    assert interaction.far[3, 4] != 0


@pytest.mark.parametrize("short", [False, True])
def test_the_cells_of_a_beam_give_the_norm_of_a_galaxy(field, short):
    """As the cells of a facet give it, though they are finer and end at half the baselines."""
    interaction = field.interaction()
    node = int(field.beams.nearest[0])
    cells = interaction.short_plane(node) if short else interaction.plane(node)
    cutout = field.plan.cutouts[0]
    norms = [
        float(np.sum(power * np.abs(plane.galaxy(uv, 1.0, (0, 0), 0.3 - 0.2j, 6 * ARCSEC)) ** 2))
        for uv, power in ((cells.uv, cells.power), (cutout.uv, field.beams.power(0, cutout)))
    ]
    limit = field.plan.bands[0].longest / (4 if short else 2)
    assert np.hypot(*cells.uv.T).max() <= limit
    assert norms[0] == pytest.approx(norms[1], rel=0.01 if short else 1e-3)  # measured 4e-3, 3e-4


def test_the_interaction_of_a_band_ends_at_half_the_longest_baseline(field):
    assert field.interaction()._band == Band(
        0.0, field.plan.bands[0].longest / 2, 2 * field.plan.pixel
    )


def test_without_short_baselines_there_is_no_cell_for_the_plateau(field):
    wanted = Wanted(SKY.l, SKY.m, np.full(5, 150 * ARCSEC), np.full(5, LONGEST))
    plan = plan_visit(wanted, 2000.0, LONGEST)
    interaction = Interaction(plan, field.beams, PROFILE)
    interaction.change_flux(np.ones(5))
    facet = np.zeros(len(plan.cutouts[3].uv), np.complex64)
    interaction.subtract_from(facet, 3)
    np.testing.assert_array_equal(facet, 0)


@pytest.mark.parametrize("name", sorted(CHANGES))
def test_a_change_is_told_in_units_of_the_noise(field, name):
    sky = CHANGES[name]
    told, _ = field.interaction().rendered(0, field.source(SKY, 0), field.source(sky, 0))
    assert told == pytest.approx(field.significance(sky), rel=0.02)
