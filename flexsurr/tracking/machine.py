"""What a training takes of its machine, by the names under which MLflow's page has a tab for it."""

import psutil

MEGABYTE = 1e6


class Machine:
    """Samples of the processor and the memory since the last one; each takes a fraction of a millisecond."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        # The first call has nothing to compare with.
        psutil.cpu_percent()
        self._process.cpu_percent()

    def sample(self) -> dict[str, float]:
        """Load and memory of the machine, and those of this process (100 % is one core)."""
        memory = psutil.virtual_memory()
        return {
            "system/cpu_utilization_percentage": psutil.cpu_percent(),
            "system/system_memory_usage_megabytes": memory.used / MEGABYTE,
            "system/system_memory_usage_percentage": memory.percent,
            "system/process_cpu_percentage": self._process.cpu_percent(),
            "system/process_memory_megabytes": self._process.memory_info().rss / MEGABYTE,
        }
