"""The stored form of a sky between two cycles; whatever can be computed from the other parts is left out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from uvshear.extraction.converged.beams import Beams
from uvshear.extraction.converged.change_image import ChangeImage, Changes
from uvshear.extraction.converged.interaction import Interaction
from uvshear.extraction.converged.major_cycle import Facets, shared_facets
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.sky_state import Fits, Linearisation, SkyState, neighbourhood_of
from uvshear.extraction.converged.sources import ModelledSource


@dataclass(frozen=True)
class KeptSky:
    """The parts of a :class:`SkyState` from which the same state can be made again, bit for bit.

    Parameters
    ----------
    fits, subtracted, facets, linearisation
        As in the state.
    changes
        Content of the image of changes.
    plan
        Plan of the last major cycle.
    """

    fits: Fits
    subtracted: Fits
    facets: Facets
    linearisation: Linearisation | None
    changes: Changes
    plan: MajorCyclePlan

    @classmethod
    def from_state(cls, state: SkyState) -> Self:
        """Take the parts of a state."""
        return cls(
            state.fits,
            state.subtracted,
            state.facets,
            state.linearisation,
            state.image.changes(),
            state.interaction.plan,
        )

    @classmethod
    def for_another_major_cycle(cls, state: SkyState) -> Self:
        """Take what another major cycle needs: no facets and no changes, which take most of the memory."""
        nothing = ChangeImage(state.interaction).changes()
        return cls(
            state.fits,
            state.subtracted,
            (),
            state.linearisation,
            nothing,
            state.interaction.plan,
        )

    def restored(self, sources: Sequence[ModelledSource], beams: Beams) -> SkyState:
        """Return the state; that for another major cycle has no facets.

        Parameters
        ----------
        sources
            The modelled sources with their priors.
        beams
            Beams of the first major cycle, which are stored on their own because they do not change.
        """
        interaction = Interaction(self.plan, beams, sources[0].profile)
        # Workers share them.
        facets = shared_facets([len(facet) for facet in self.facets])
        for facet, kept in zip(facets, self.facets, strict=True):
            facet[:] = kept
        return SkyState(
            sources=tuple(sources),
            fits=self.fits,
            subtracted=self.subtracted,
            facets=facets,
            image=ChangeImage.from_changes(interaction, self.changes),
            interaction=interaction,
            neighbourhood=neighbourhood_of(self.plan, sources, self.subtracted),
            linearisation=self.linearisation,
        )
