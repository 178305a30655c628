"""Scenarios from TTOBench: a track, a train, and if wanted a journey."""

from dataclasses import dataclass, replace
from typing import Any

from railjoule.core.imports.findings import Finding, Imported
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.ttobench.journey import StopChoice, read_service
from railjoule.core.imports.ttobench.track import read_track
from railjoule.core.imports.ttobench.train import read_train
from railjoule.core.scenario import Line, Timetable, Vehicle


@dataclass(frozen=True)
class ImportedScenario(Imported):
    """A scenario; without `travel_time_s` its document lacks the timetable."""

    line: Line
    vehicle: Vehicle
    travel_time_s: float | None = None

    def with_travel_time(self, travel_time_s: float, finding: Finding) -> "ImportedScenario":
        """Return the scenario with a time for the whole run [s], and where that time is from."""
        timetable = {**self.document.get("timetable", {}), "travel_time_s": travel_time_s}
        return replace(
            self,
            document={**self.document, "timetable": timetable},
            travel_time_s=travel_time_s,
            findings=(*self.findings, finding),
        )


def read_ttobench(
    track: SourceFile,
    train: SourceFile,
    journey: SourceFile | None = None,
    *,
    stops: StopChoice = "all",
    travel_time_s: float | None = None,
) -> ImportedScenario:
    """Return the scenario of a track, a train and a journey.

    Parameters
    ----------
    track, train, journey : SourceFile
        JSON files of TTOBench 1.1 to 1.5; of other versions what is known is read.
    stops : str
        Stop at all stops, or at the ends alone.
    travel_time_s : float, optional
        Time for the whole run [s]; by default the journey's, without one left open.

    Raises
    ------
    ScenarioError
        If anything is wrong with a file; the sentence names field, value and bound.
    """
    vehicle = read_train(train)
    service = read_service(journey, stops) if journey is not None else None
    line = read_track(track, vehicle.tunnels, stops=stops, service=service)
    findings, unused = [*line.findings, *vehicle.findings], [*line.unused, *vehicle.unused]
    timetable: dict[str, Any] = {}
    if service is not None:
        findings, unused = [*findings, *service.findings], [*unused, *service.unused]
        for key, speed in (("entry_speed_kmh", service.entry_kmh), ("exit_speed_kmh", service.exit_kmh)):
            if speed and key in Timetable.model_fields:
                timetable[key] = speed
            elif speed:
                unused.append(f"{service.source}: {key} = {speed:g}: the train stands there in a scenario.")
    if travel_time_s is None and service is not None:
        travel_time_s = service.travel_time_s
    if travel_time_s is not None:
        timetable["travel_time_s"] = travel_time_s
    if vehicle.vehicle.resistance.curve_constant_m_n_per_kn == 0 and any(s.curve_radius_m for s in line.line.sections):
        sentence = f"{train.name}: no resistance of curves: vehicle.resistance.curve_constant_m_n_per_kn is 0."
        findings.append(Finding("assumption", sentence))
    sources = ", ".join(file.name for file in (track, train, journey) if file is not None)
    document: dict[str, Any] = {"title": f"{line.line.name}, {vehicle.vehicle.name}"[:200]}
    document |= {**vehicle.document, **line.document, **({"timetable": timetable} if timetable else {})}
    return ImportedScenario(
        sources, document, line.line, vehicle.vehicle, travel_time_s, findings=tuple(findings), unused=tuple(unused)
    )
