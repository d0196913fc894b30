"""Structure of the model: what the user requests, what follows from known quantities, and what the recordings decide."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from sprung.campaign import Campaign
from sprung.errors import Problems, did_you_mean
from sprung.estimation import USUAL_ENGINE_FREQUENCY, LowPass, UsualValue, VehicleSize
from sprung.uncertainty import KnownValue
from sprung.vehicle import (
    EXTRAS,
    LINEAR_EXTRAS,
    REFINED,
    CarriedAt,
    Element,
    Heights,
    Layout,
    LinearModel,
    Load,
    NonlinearModel,
    Sensor,
    Tracks,
    coordinates,
    ground_contact_elements,
    half_distances,
    linear_elements,
    nonlinear_elements,
    parameter_names,
    parameters_of_term,
    stiffened_air_springs,
    terms_of,
)

SEAT_LOAD = "seat-load"
"""Term of loads on seats: the campaign says whether it is there."""

_BOTH: tuple[Tracks, ...] = ("separate", "shared")
_SEPARATE, _SHARED = (tuple(half_distances(tracks).values()) for tracks in _BOTH)


@dataclass(frozen=True, eq=False)
class ModelStructure:
    """The model to fit.

    Attributes
    ----------
    campaign
        The campaign, for its loads, sensors and heights.
    tracks
        Whether springs and dampers of an axle share their half-distance.
    terms
        Model terms beside the paper's seven degrees of freedom.
    known
        Everything known beforehand about its parameters, the wheelbase included.
    tracks_open
        Whether the recordings decide about the tracks: neither the user nor a known half-distance does.
    open_terms
        Terms about which the recordings decide.
    gravity_leakage
        Whether the sensors tilt with the body, so that they feel the less of gravity the further it turns: an effect of the
        second order that only the model with forces beside it can show.
    low_pass
        Of the loggers, which all channels passed, likewise; None for none.
    unilateral_tyres
        Whether wheels may be off the ground, so that the ground is a force beside the others.
    stop_gap
        Compression at which bump stops are met, where a fit begins, m.
    dampers_steepen
        Whether the curves of dampers steepen beyond their knee, where a fit begins; else they flatten, as most do.
    engine_frequency, engine_place
        Natural frequency, Hz, of an engine on its mounts and its place forward of the front axle, m, where a fit begins.
    body_frequency
        Frequency of the body's twist or bending, where a fit begins, Hz.
    seat_place
        Place of people on soft seats behind the front axle, where a fit begins, as a part of the wheelbase.
    carried_at
        Where the body is carried sideways, where two heights are known at which it may be.
    usual
        Usual values of parameters, which are weak priors.
    step_part
        Part of the usual length of steps in time that its fits take.
    assumed_heights
        Heights where the campaign does not state enough of them, as far as the recordings show them; None for no effect.
    sinking
        How much lower the body rests on its wheels under each load, m, by the load's name; empty where that is not considered.
    """

    campaign: Campaign
    tracks: Tracks
    terms: tuple[str, ...]
    known: Mapping[str, KnownValue]
    tracks_open: bool
    open_terms: tuple[str, ...]
    gravity_leakage: bool = False
    low_pass: LowPass | None = None
    unilateral_tyres: bool = False
    stop_gap: float = 1.0
    dampers_steepen: bool = False
    engine_frequency: float = USUAL_ENGINE_FREQUENCY
    engine_place: float = 0.0
    body_frequency: float = 12.0
    seat_place: float = 0.45
    carried_at: CarriedAt = "wheels"
    usual: Mapping[str, UsualValue] = field(default_factory=dict)
    step_part: float = 1.0
    assumed_heights: Heights | None = None
    sinking: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def decided(cls, campaign: Campaign, tracks: Tracks, terms: tuple[str, ...]) -> ModelStructure:
        """Return the structure with some tracks and terms, about which the recordings decide nothing.

        Parameters
        ----------
        campaign
            The campaign; what it states of other terms is of no use.
        tracks, terms
            Of the structure.
        """
        used = campaign.with_used_loads
        return cls(used, tracks, terms, _everything_known(used), False, ())

    @property
    def heights(self) -> Heights:
        """Heights of the campaign, with the one at which the body is carried sideways, or those assumed."""
        return self.assumed_heights or self.campaign.heights._replace(carried_at=self.carried_at)

    def heights_of(self, load: str) -> Heights:
        """Return the heights with the body as low as it rests under a load, by the load's name."""
        return self.heights._replace(sunk=self.sinking.get(load, 0.0))

    @cached_property
    def wheelbase(self) -> float:
        """Wheelbase over which the body twists and bends, m: the known one, or that of the sensors."""
        return VehicleSize.of(self.known, self.campaign.sensors, self.layout).wheelbase

    @property
    def layout(self) -> Layout:
        """Coordinates and wheel stations of the vehicle."""
        return self.campaign.layout

    @cached_property
    def sensors(self) -> tuple[Sensor, ...]:
        """Sensors of the campaign, with what their tilt adds to the uncertainty of their places where heights are known."""
        height, sensors = self.heights.cg_height, self.campaign.sensors
        return sensors if height is None else tuple(sensor.at_height_above(height) for sensor in sensors)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The parameters: the vehicle's, and the masses of loads that are known with an uncertainty."""
        used = {drop.load for drop in self.campaign.drops}
        masses = [name for load in self.campaign.loads if load.name in used for name in load.uncertain_masses]
        return (*parameter_names(self.tracks, self.terms, self.layout), *masses)

    @cached_property
    def linear_models(self) -> Mapping[str, LinearModel]:
        """Linear equations of motion by load name, without nonlinear forces."""
        return {
            load.name: LinearModel.of(
                self._elements(load) + load.elements(self.heights_of(load.name), self.names, self.wheelbase),
                self.names,
            )
            for load in self.campaign.loads
        }

    @cached_property
    def nonlinear_models(self) -> Mapping[str, NonlinearModel]:
        """Equations of motion by load name, with nonlinear forces."""
        contact = ground_contact_elements(self.terms, self.layout) if self.unilateral_tyres else ()
        models = {}
        for load in self.campaign.loads:
            at_wheels = load.mass_at_wheels(self.wheelbase, self.layout)
            forces = nonlinear_elements(self.tracks, self.terms, self.wheelbase, at_wheels, self.layout) + contact
            heights = self.heights_of(load.name)
            models[load.name] = NonlinearModel.of(
                self._elements(load), forces, self.names, load, heights, wheelbase=self.wheelbase
            )
        return models

    def _elements(self, load: Load) -> tuple[Element, ...]:
        """Return the linear elements of the vehicle, as it stands under a load."""
        elements = self._elements_at[self.heights_of(load.name)]
        at_wheels = load.mass_at_wheels(self.wheelbase, self.layout)
        return elements + stiffened_air_springs(at_wheels, self.tracks, self.terms, self.wheelbase, self.layout)

    @cached_property
    def _elements_at(self) -> Mapping[Heights, tuple[Element, ...]]:
        """The linear elements of the vehicle at each of the heights at which its loads let it stand."""
        return {
            heights: linear_elements(self.tracks, self.terms, heights, self.wheelbase, self.layout)
            for heights in {self.heights_of(load.name) for load in self.campaign.loads}
        }

    @property
    def is_nonlinear(self) -> bool:
        """Whether it has nonlinear terms."""
        return any(extra not in LINEAR_EXTRAS for extra in self.terms)

    @property
    def is_time_stepped(self) -> bool:
        """Whether its motion has to be computed by time stepping."""
        return self.is_nonlinear or self.unilateral_tyres

    @property
    def needs_start(self) -> bool:
        """Whether it has coordinates that only a vehicle which is fitted already shows: no fit begins from nothing."""
        return not {*coordinates(self.names)} <= {*self.layout.coordinates, "z_e"}

    @property
    def linear_terms(self) -> tuple[str, ...]:
        """Its terms that mass, damping and stiffness matrices carry."""
        return tuple(extra for extra in self.terms if extra in LINEAR_EXTRAS)

    def with_terms(self, terms: tuple[str, ...], tracks: Tracks | None = None) -> ModelStructure:
        """Return the structure with other terms, and other tracks."""
        ordered = tuple(extra for extra in EXTRAS if extra in terms)
        changed = replace(self, tracks=tracks or self.tracks, terms=ordered)
        return replace(changed, usual={name: value for name, value in self.usual.items() if name in changed.names})


def choose_structure(
    campaign: Campaign, tracks: Tracks | None = None, extras: tuple[str, ...] | None = None
) -> ModelStructure:
    """Return the structure for a campaign, as far as it follows without the recordings.

    Parameters
    ----------
    campaign
        The campaign.
    tracks, extras
        Override what the campaign's own ``[model]`` says.

    Returns
    -------
    ModelStructure

    Raises
    ------
    InputError
        If an extra is unknown or forbidden, or known half-distances contradict the choice of tracks.
    """
    problems = Problems()
    where = "campaign" if campaign.path is None else campaign.path.name
    wanted = campaign.model.extras if extras is None else extras
    is_soft = any(load.is_soft for load in campaign.with_used_loads.loads)
    chosen_extras = (*(wanted or ()), *((SEAT_LOAD,) if is_soft and SEAT_LOAD not in (wanted or ()) else ()))
    forbidden = campaign.model.forbid if extras is None else ()
    for extra in chosen_extras:
        _check_extra(extra, campaign.layout, chosen_extras, forbidden, where, problems)

    apart = [name for name in _SEPARATE if name in campaign.known]
    together = [name for name in _SHARED if name in campaign.known]
    chosen: Tracks = tracks or campaign.model.tracks or ("separate" if apart else "shared")
    clash = apart if chosen == "shared" else together
    if clash:
        problems.add(
            f"{where}: known.{clash[0]}",
            f'{", ".join(clash)} with tracks = "{chosen}"',
            "t_f and t_r where springs and dampers share their half-distance, t_f1, t_r1, t_f2 and t_r2 where not",
            'Set tracks = "separate" in [model] or rename the known half-distances.',
        )
    if SEAT_LOAD in chosen_extras and not is_soft:
        do = f"Say which items do, or remove '{SEAT_LOAD}'."
        problems.add(f"{where}: model.extras", "no item of a load on a seat", 'an item with on = "seat"', do)
    layout = campaign.layout
    names = parameter_names(chosen, chosen_extras, layout) if not problems else ()
    for extra in EXTRAS:
        brought = parameters_of_term(extra, chosen, layout)
        for name in (one for one in brought if one in campaign.known and names and one not in names):
            problems.add(
                f"{where}: known.{name}", "a parameter that the model does not have", f"the extra '{extra}'",
                f'Add extras = ["{extra}"] to [model], or remove it.',
            )  # fmt: skip
    problems.raise_if_any()

    undecided = layout.rolls and tracks is None and campaign.model.tracks is None and not apart and not together
    # Where heights are known they say all that gravity does.
    said = (*campaign.model.forbid, *(("gravity",) if campaign.heights.has_effect else ()))
    said += tuple(extra for extra, refined in REFINED.items() if refined in said)
    free = tuple(
        extra for extra in EXTRAS if wanted is None and extra not in (*said, SEAT_LOAD) and extra in terms_of(layout)
    )
    ordered = tuple(extra for extra in EXTRAS if extra in chosen_extras)
    return replace(ModelStructure.decided(campaign, chosen, ordered), tracks_open=undecided, open_terms=free)


def _everything_known(campaign: Campaign) -> Mapping[str, KnownValue]:
    """Return what a campaign states of the vehicle, with its wheelbase, and of the masses of its loads, SI, by name."""
    known = dict(campaign.known)
    if campaign.wheelbase is not None:
        known["wheelbase"] = campaign.wheelbase
    for load in campaign.loads:
        known |= load.uncertain_masses
    return known


def _check_extra(
    extra: str, layout: Layout, chosen: Collection[str], forbidden: Collection[str], where: str, problems: Problems
) -> None:
    """Add what is wrong with an extra that is wanted, beside all others that are."""
    if extra not in EXTRAS:
        do = did_you_mean(extra, EXTRAS)
        problems.add(f"{where}: model.extras", f"'{extra}'", f"any of {', '.join(EXTRAS)}", do)
    elif extra not in terms_of(layout):
        found, do = f"'{extra}', of a vehicle with model = \"{layout.model}\"", "Remove it."
        problems.add(f"{where}: model.extras", found, f"any of {', '.join(terms_of(layout))}", do)
    elif REFINED.get(extra, extra) not in (extra, *chosen):
        problems.add(
            f"{where}: model.extras",
            f"'{extra}' without '{REFINED[extra]}'",
            "both: one is nothing without the other",
            f"Add '{REFINED[extra]}', or remove '{extra}'.",
        )
    elif extra in forbidden:
        problems.add(f"{where}: model", f"'{extra}' both wanted and forbidden", "one of the two", "Remove one.")
