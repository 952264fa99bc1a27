"""The train sets in the stability matrix."""

from sweeps import EITHER, Sweep

TRAINS = (
    # at 300 km/h a tooth goes through its rib, which is told
    Sweep(
        "trains at 3 to 300 km/h, m/s",
        "extreme/trains",
        "speed",
        (3 / 3.6, 55 / 3.6, 300 / 3.6),
        EITHER,
        "has passed the middle",
    ),
    Sweep(
        "trains with little or no gap between cars, m", "extreme/trains", "slack", (0, 1e-9, 1e-3)
    ),
    Sweep(
        "trains that touch at the start, m/s",
        "extreme/trains",
        "speed",
        (3 / 3.6, 300 / 3.6),
        EITHER,
        "has passed the middle",
        also={"slack": "0", "run_in": "0"},
    ),
)
