"""The functions that draw the figures of the catalogue, by their names."""

from collections.abc import Callable

from matplotlib.figure import Figure

from flexsurr.report.airliner_flight_figures import (
    aileron_doublet,
    figure_18,
    figure_19,
    figure_20,
    figure_21,
    rudder_doublet,
)
from flexsurr.report.airliner_geometry_figures import elastic_modes, figure_16, figure_17
from flexsurr.report.architecture_figures import architecture_errors
from flexsurr.report.beam_figures import figure_08, figure_09, reduced_against_full, static_deflection
from flexsurr.report.cost_figures import cost_accuracy
from flexsurr.report.crossover_figure import crossover
from flexsurr.report.energy_figures import energy_decay, energy_drift, figure_13
from flexsurr.report.kinematic_figures import figure_03, figure_04
from flexsurr.report.pareto_figures import pareto
from flexsurr.report.response_figures import (
    figure_10,
    figure_12,
    figure_14,
    figure_15,
    forced_response_of_every_model,
    free_response_of_every_model,
    phase_plane,
    rollouts,
)
from flexsurr.report.schematics import figure_05, figure_06, figure_07, figure_11
from flexsurr.report.shape_figures import mode_shapes, static_shapes
from flexsurr.report.training_figures import coefficient_errors, training_epochs, training_loss
from flexsurr.report.trial_figures import trials

DRAW: dict[str, Callable[..., Figure]] = {
    draw.__name__: draw
    for draw in (
        figure_03,
        figure_04,
        figure_05,
        figure_06,
        figure_07,
        figure_08,
        figure_09,
        figure_10,
        figure_11,
        figure_12,
        figure_13,
        figure_14,
        figure_15,
        mode_shapes,
        static_shapes,
        static_deflection,
        reduced_against_full,
        free_response_of_every_model,
        forced_response_of_every_model,
        energy_drift,
        energy_decay,
        architecture_errors,
        cost_accuracy,
        rollouts,
        phase_plane,
        training_loss,
        training_epochs,
        trials,
        pareto,
        figure_16,
        figure_17,
        figure_18,
        figure_19,
        figure_20,
        figure_21,
        aileron_doublet,
        rudder_doublet,
        elastic_modes,
        coefficient_errors,
        crossover,
    )
}
