"""What the workbench computes: the only place of the dashboard that asks the core to solve."""

from railjoule.dashboard.store.disturbances import (
    LateArrivals,
    Rides,
    RidesWish,
    compute_late_arrivals,
    compute_rides,
)
from railjoule.dashboard.store.robustness import (
    Reality,
    RealityWish,
    TableWish,
    compute_chance,
    compute_reality,
    compute_table,
)
from railjoule.dashboard.store.runs import Runs, RunsWish, compute_runs, compute_runs_in_steps
from railjoule.dashboard.store.speed_limits import (
    LimitRun,
    LimitsWish,
    LimitTrip,
    StorageCurve,
    StorageWish,
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
)
from railjoule.dashboard.store.trade_off import EnocMap, TradeOff, TradeOffWish, compute_trade_off
from railjoule.dashboard.store.worker import Study, Worker

__all__ = [
    "EnocMap",
    "LateArrivals",
    "LimitRun",
    "LimitTrip",
    "LimitsWish",
    "Reality",
    "RealityWish",
    "Rides",
    "RidesWish",
    "Runs",
    "RunsWish",
    "StorageCurve",
    "StorageWish",
    "Study",
    "TableWish",
    "TradeOff",
    "TradeOffWish",
    "Worker",
    "compute_chance",
    "compute_late_arrivals",
    "compute_limit_run",
    "compute_limit_trip",
    "compute_reality",
    "compute_rides",
    "compute_runs",
    "compute_runs_in_steps",
    "compute_storage",
    "compute_table",
    "compute_trade_off",
]
