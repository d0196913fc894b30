"""Many campaigns: tasks on local processes or a Dask cluster, one row for each in Parquet files, resumed where they stopped."""

from sprung.batch.counts import BatchCounts, BatchStep, describe_counts
from sprung.batch.dask_workers import DaskWorkers
from sprung.batch.executor import Executor, choose_executor
from sprung.batch.local_workers import LocalWorkers
from sprung.batch.locking import folder_lock
from sprung.batch.run import DONE, BatchSummary, run_batch
from sprung.batch.shards import ShardFolder, read_rows, write_table
from sprung.batch.task import Columns, Failure, Kind, Row, Task, Work, canonical_text, content_key

__all__ = [
    "DONE",
    "BatchCounts",
    "BatchStep",
    "BatchSummary",
    "Columns",
    "DaskWorkers",
    "Executor",
    "Failure",
    "Kind",
    "LocalWorkers",
    "Row",
    "ShardFolder",
    "Task",
    "Work",
    "canonical_text",
    "choose_executor",
    "content_key",
    "describe_counts",
    "folder_lock",
    "read_rows",
    "run_batch",
    "write_table",
]
