"""Fleets: many campaigns identified in one go, and what their vehicles tell together."""

from sprung.fleets.campaigns import FleetSource, campaign_key, find_campaigns
from sprung.fleets.charts import RIG_FAULTS, ControlChart, Deviation, RigAlarm, VehicleAlarm, chart_vehicles
from sprung.fleets.estimates import (
    NEEDED,
    WHEELBASE,
    FleetEstimates,
    Quantity,
    collect_estimates,
    label_vehicles,
    quantity_of,
)
from sprung.fleets.fleet import CONTENT, HIERARCHICAL_COLUMNS, HIERARCHICAL_FOLDER, Fleet, fleet
from sprung.fleets.population import FEWEST, Population, VehicleEstimates, estimate_vehicles, fit_population
from sprung.fleets.rows import COLUMNS, QUANTITIES, VECTOR, identify_row, row_of
from sprung.fleets.run_length import (
    RUN_LENGTH,
    WEIGHT,
    alarm_limit,
    average_run_length,
    clipping_radius,
)
from sprung.fleets.scores import Scores, hypothesis_scores, largest_component, score_vehicles
from sprung.fleets.survey import ALL_VEHICLES, FleetType, ParameterSpread, Survey, in_test_order, survey_types

__all__ = [
    "ALL_VEHICLES",
    "COLUMNS",
    "CONTENT",
    "FEWEST",
    "HIERARCHICAL_COLUMNS",
    "HIERARCHICAL_FOLDER",
    "NEEDED",
    "QUANTITIES",
    "RIG_FAULTS",
    "RUN_LENGTH",
    "VECTOR",
    "WEIGHT",
    "WHEELBASE",
    "ControlChart",
    "Deviation",
    "Fleet",
    "FleetEstimates",
    "FleetSource",
    "FleetType",
    "ParameterSpread",
    "Population",
    "Quantity",
    "RigAlarm",
    "Scores",
    "Survey",
    "VehicleAlarm",
    "VehicleEstimates",
    "alarm_limit",
    "average_run_length",
    "campaign_key",
    "chart_vehicles",
    "clipping_radius",
    "collect_estimates",
    "estimate_vehicles",
    "find_campaigns",
    "fit_population",
    "fleet",
    "hypothesis_scores",
    "identify_row",
    "in_test_order",
    "label_vehicles",
    "largest_component",
    "quantity_of",
    "row_of",
    "score_vehicles",
    "survey_types",
]
