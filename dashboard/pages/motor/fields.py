"""The sidebar's part of Motor: the controller, and the limits of the inverter."""

from typing import Any

from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.parts.choices import box, menu
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import number_fields
from railjoule.dashboard.state.workbench import Workbench

FLUX_WORDS = {"Constant": "constant", "Least loss": "min_loss"}


class MotorFields:
    """The fields of controller and inverter; in sight on Motor alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.motor
        model = self.model
        self.precompensator = box(model, "precompensator", "Pre-compensator", margin=(0, 16, 0, 14))
        self.flux = menu(model, "flux", "Rotor flux", FLUX_WORDS)
        self.view = stack(
            html_pane('<div class="section">Controller <span>\u00b7 with a rotor resistance of its own</span></div>'),
            self.precompensator,
            self.flux,
            *number_fields(model, "bandwidth_rads", "rotor_resistance_factor", "speed_noise_rads", "noise_seed"),
            html_pane(
                markup(
                    '<div class="row small"><span>From its resistance it computes the slip.{}</span></div>',
                    info("Slip"),
                )
            ),
            html_pane('<div class="section">Inverter <span>\u00b7 at most, each phase</span></div>'),
            *number_fields(model, "max_phase_voltage_v", "max_current_a"),
            html_pane('<hr class="rule">'),
            visible=not model.no_machine,
        )
        model.param.watch(self._show, "no_machine")

    def _show(self, *_: Any) -> None:
        self.view.visible = not self.model.no_machine
