# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
PathLike = Union[str, "os.PathLike[str]"]

__version__: str

class Error(Exception):
    code: str

def default_isa() -> str: ...
def available_isas() -> list[str]: ...
def planner_names() -> list[str]: ...
def sampler_names() -> list[str]: ...
def kind_names() -> list[str]: ...
def find_scene(name: PathLike) -> str: ...
def drop_own_points(
    scene: "Scene", robot: "Robot", q: npt.ArrayLike, distance: float
) -> list[str]: ...
def list_problems(path: PathLike) -> list[str]: ...

class Robot:
    @staticmethod
    def load(
        robot: PathLike,
        *,
        srdf: PathLike = "",
        group: str = "",
        joints: Sequence[str] = ...,
        package_paths: Sequence[PathLike] = ...,
        fixed_values: Mapping[str, float] = ...,
        strict: bool = False,
        hard_limits: bool = False,
        excess: float = 0.015,
        tip_excess: float = 0.005,
        max_per_link: int = 1000,
    ) -> Robot: ...
    @staticmethod
    def planar(lengths: npt.ArrayLike, *, thickness: float = 0.001, name: str = "") -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def joint_count(self) -> int: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def link_names(self) -> list[str]: ...
    @property
    def limits(self) -> Floats: ...
    @property
    def hash(self) -> str: ...
    @property
    def kinematics_hash(self) -> str: ...
    @property
    def is_planar(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...
    def link_poses(self, q: npt.ArrayLike) -> Floats: ...
    def describe_violation(self, q: npt.ArrayLike) -> Optional[str]: ...
    def normalized(self, q: npt.ArrayLike) -> Floats: ...
    def difference(self, a: npt.ArrayLike, b: npt.ArrayLike) -> Floats: ...
    def distance(self, a: npt.ArrayLike, b: npt.ArrayLike) -> float: ...
    def path_length(self, path: npt.ArrayLike) -> float: ...
    def attach(self, link: str, objects: Scene, *, touch: Sequence[str] = ...) -> Robot: ...
    def detach(self, name: str) -> Robot: ...
    @property
    def attached(self) -> list[str]: ...

class Scene:
    name: str
    def __init__(self, name: str = "scene") -> None: ...
    @staticmethod
    def load(path: PathLike, robot: Optional[Robot] = None) -> Scene: ...
    @staticmethod
    def parse(yaml: str, source: str = "scene") -> Scene: ...
    @staticmethod
    def from_circles(circles: npt.ArrayLike, name: str = "scene") -> Scene: ...
    @property
    def obstacle_names(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def add_sphere(self, name: str, position: npt.ArrayLike, radius: float) -> None: ...
    def add_box(
        self,
        name: str,
        position: npt.ArrayLike,
        size: npt.ArrayLike,
        quat_xyzw: Optional[npt.ArrayLike] = None,
    ) -> None: ...
    def add_cylinder(
        self,
        name: str,
        position: npt.ArrayLike,
        radius: float,
        length: float,
        quat_xyzw: Optional[npt.ArrayLike] = None,
    ) -> None: ...
    def add_capsule(
        self, name: str, a: npt.ArrayLike, b: npt.ArrayLike, radius: float
    ) -> None: ...
    def add_points(
        self,
        name: str,
        points: npt.ArrayLike,
        radius: float,
        position: npt.ArrayLike = ...,
        quat_xyzw: Optional[npt.ArrayLike] = None,
    ) -> int: ...
    def add_mesh(
        self,
        name: str,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        position: npt.ArrayLike = ...,
        quat_xyzw: Optional[npt.ArrayLike] = None,
    ) -> None: ...
    def replace_points(self, name: str, first: int, points: npt.ArrayLike) -> None: ...
    def remove(self, name: str) -> None: ...
    def move(
        self, name: str, position: npt.ArrayLike, quat_xyzw: Optional[npt.ArrayLike] = None
    ) -> None: ...
    def copy(self) -> Scene: ...
    def to_compact_json(self) -> str: ...
    def allow(self, link: str, obstacle: str, at_ends: Optional[float] = ...) -> None: ...
    def to_yaml(self) -> str: ...
    def __len__(self) -> int: ...

class PoseGoal:
    def __init__(
        self,
        link: str,
        position: npt.ArrayLike,
        quat_xyzw: Optional[npt.ArrayLike] = None,
        *,
        position_tolerance: Union[float, npt.ArrayLike] = 0.0,
        axis: str = "z",
        cone: Union[float, str] = 0.0,
        turn: Union[float, str] = 0.0,
        frame: str = "",
    ) -> None: ...
    @property
    def link(self) -> str: ...
    @property
    def position(self) -> Floats: ...
    @property
    def quat_xyzw(self) -> Floats: ...
    @property
    def position_tolerance(self) -> Floats: ...
    @property
    def axis(self) -> str: ...
    @property
    def cone(self) -> float: ...
    @property
    def turn(self) -> float: ...
    @property
    def frame(self) -> str: ...
    def to_json(self) -> str: ...

class OrientationConstraint:
    def __init__(
        self, link: str, angle: float, *, axis: npt.ArrayLike = ..., up: npt.ArrayLike = ...
    ) -> None: ...
    @property
    def link(self) -> str: ...
    @property
    def angle(self) -> float: ...
    @property
    def axis(self) -> Floats: ...
    @property
    def up(self) -> Floats: ...
    def tilt(self, robot: Robot, q: npt.ArrayLike) -> float: ...

class CellAnswer:
    @property
    def tier(self) -> str: ...
    @property
    def box(self) -> int: ...
    @property
    def path(self) -> Floats: ...
    @property
    def message(self) -> str: ...

class CellMotions:
    def __init__(self, cell: Cell) -> None: ...
    def trajectory(self, answer: CellAnswer, dt: Optional[float] = None,
                   limits: Optional[PathLike] = None, **settings: Any) -> Trajectory: ...

class Cell:
    @staticmethod
    def build(
        region: str,
        *,
        # settings:cell
        seconds: float = 60.0,
        boxes: int = 1000000,
        threads: int = 1,
        margin: float = 0.0005,
        seed: int = 1,
        # /settings
    ) -> Cell: ...
    @staticmethod
    def load(path: PathLike, region: PathLike = "") -> Cell: ...
    def ask(
        self, task: npt.ArrayLike, start: str = "start", timeout: float = 1.0
    ) -> CellAnswer: ...
    def coverage(self, start: str = "start", samples: int = 10000) -> dict[str, Any]: ...
    def verify(self, samples: int = 1000, seed: int = 1, threads: int = 1) -> dict[str, int]: ...
    def save(self, path: PathLike) -> None: ...
    @property
    def box_count(self) -> int: ...
    @property
    def proven_count(self) -> int: ...
    @property
    def is_of_this_world(self) -> bool: ...
    @property
    def margin(self) -> float: ...

class Solutions(np.ndarray[Any, np.dtype[np.float64]]):
    message: str

def inverse_kinematics(
    robot: Robot,
    goals: Union[PoseGoal, Sequence[PoseGoal]],
    *,
    near: Optional[npt.ArrayLike] = None,
    scene: Scene = ...,
    seed: int = 1,
    isa: str = "automatic",
    # settings:ik
    ik_seeds: int = 2048,
    ik_solutions: int = 8,
    ik_position_tolerance: float = 0.0001,
    ik_rotation_tolerance: float = 0.001,
    ik_apart: float = 0.1,
    # /settings
) -> Solutions: ...

class Line:
    def __init__(
        self,
        link: str = "",
        *,
        by: Optional[npt.ArrayLike] = None,
        to: Optional[PoseGoal] = None,
        from_: Optional[PoseGoal] = None,
        frame: str = "",
        free_axis: str = "",
        position_tolerance: float = ...,
        rotation_tolerance: float = ...,
    ) -> None: ...
    @property
    def link(self) -> str: ...
    @property
    def frame(self) -> str: ...
    @property
    def position_tolerance(self) -> float: ...
    @property
    def rotation_tolerance(self) -> float: ...

class LineResult:
    @property
    def is_whole(self) -> bool: ...
    @property
    def fraction(self) -> float: ...
    @property
    def path(self) -> Floats: ...
    @property
    def fractions(self) -> Floats: ...
    @property
    def others(self) -> list[Floats]: ...
    @property
    def position_deviation(self) -> float: ...
    @property
    def rotation_deviation(self) -> float: ...
    @property
    def reason(self) -> str: ...
    @property
    def branches(self) -> int: ...
    @property
    def steps(self) -> int: ...
    @property
    def is_timed_out(self) -> bool: ...

def plan_line(
    robot: Robot,
    line: Line,
    start: Optional[npt.ArrayLike] = None,
    *,
    scene: Scene = ...,
    isa: str = "automatic",
    # settings:line
    timeout: float = 1.0,
    line_steps: int = 1000,
    line_paths: int = 1,
    seed: int = 1,
    # /settings
) -> LineResult: ...

class Problem:
    name: str
    def __init__(
        self,
        robot: Robot,
        scene: Scene,
        start: npt.ArrayLike,
        goals: Optional[npt.ArrayLike] = None,
        name: str = "problem",
        *,
        pose_goals: Sequence[PoseGoal] = ...,
        constraints: Sequence[OrientationConstraint] = ...,
        start_velocity: Optional[npt.ArrayLike] = None,
        end_velocity: Optional[npt.ArrayLike] = None,
    ) -> None: ...
    @staticmethod
    def load(
        where: PathLike,
        *,
        robot: Union[PathLike, Robot] = "",
        start: Optional[npt.ArrayLike] = None,
        start_velocity: Optional[npt.ArrayLike] = None,
        end_velocity: Optional[npt.ArrayLike] = None,
        goal: Optional[npt.ArrayLike] = None,
        pose_goals: Sequence[PoseGoal] = ...,
        constraints: Sequence[OrientationConstraint] = ...,
        srdf: PathLike = "",
        group: str = "",
        package_paths: Sequence[PathLike] = ...,
        self_filter: Optional[float] = None,
        strict: bool = False,
        hard_limits: bool = False,
    ) -> Problem: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def start(self) -> Floats: ...
    @property
    def start_velocity(self) -> Floats: ...
    @property
    def end_velocity(self) -> Floats: ...
    @property
    def goals(self) -> Floats: ...
    @property
    def pose_goals(self) -> Sequence[PoseGoal]: ...
    @property
    def constraints(self) -> Sequence[OrientationConstraint]: ...
    @property
    def warnings(self) -> Sequence[str]: ...
    def with_start(
        self, start: npt.ArrayLike, start_velocity: Optional[npt.ArrayLike] = None
    ) -> Problem: ...
    def with_goal(
        self, goal: npt.ArrayLike, end_velocity: Optional[npt.ArrayLike] = None
    ) -> Problem: ...
    def with_scene(self, scene: Scene) -> Problem: ...
    def with_constraints(self, constraints: Sequence[OrientationConstraint]) -> Problem: ...
    def to_yaml(self, robot: str) -> str: ...
    def to_compact_json(self, robot: str) -> str: ...

class CollisionChecker:
    def __init__(
        self,
        robot: Robot,
        scene: Scene,
        *,
        resolution: Optional[float] = None,
        margin: float = 0.0,
        isa: str = "automatic",
    ) -> None: ...
    @property
    def resolution(self) -> float: ...
    @property
    def margin(self) -> float: ...
    @property
    def isa(self) -> str: ...
    def is_valid(self, q: npt.ArrayLike) -> Union[bool, npt.NDArray[np.bool_]]: ...
    def is_motion_valid(self, start: npt.ArrayLike, end: npt.ArrayLike) -> bool: ...
    def contacts(self, q: npt.ArrayLike) -> list[dict[str, Any]]: ...
    def is_path_free(self, path: npt.ArrayLike, resolution: Optional[float] = None, *,
                     start_tolerance: float = ..., allow_at_ends: float = ...) -> bool: ...

class Primitive:
    @staticmethod
    def from_circles(circles: npt.ArrayLike) -> Primitive: ...
    @property
    def key(self) -> Floats: ...
    @property
    def gap(self) -> float: ...
    @property
    def obstacles(self) -> list[int]: ...

def decompose(
    robot: Robot,
    scene: Scene,
    *,
    kind: Optional[str] = None,
    # settings:memory
    max_gap: Optional[float] = None,
    # /settings
) -> list[Primitive]: ...
def similarity_error(a: npt.ArrayLike, b: npt.ArrayLike, kind: str = "pairs") -> float: ...

class Database:
    @staticmethod
    def open(
        path: PathLike,
        robot: Optional[Robot] = None,
        *,
        mode: str = "read_only",
        memory_mib: int = 256,
    ) -> Database: ...
    @staticmethod
    def verify(path: PathLike) -> list[tuple[int, str]]: ...
    def find(
        self,
        primitive: Primitive,
        *,
        similarity: Optional[float] = None,
        max_matches: int = 8,
        mirror: bool = True,
    ) -> list[dict[str, Any]]: ...
    def to_arrays(self) -> dict[str, npt.NDArray[Any]]: ...
    def info(self) -> dict[str, Any]: ...
    def flush(self, timeout: float = 30.0) -> None: ...
    def close(self) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, position: int) -> dict[str, Any]: ...
    def __enter__(self) -> Database: ...
    def __exit__(self, *args: object) -> None: ...

class LearnProgress:
    @property
    def done(self) -> int: ...
    @property
    def total(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def elapsed_s(self) -> float: ...

class LearnSummary:
    @property
    def learned(self) -> int: ...
    @property
    def unsolved(self) -> list[str]: ...
    @property
    def rows(self) -> int: ...
    @property
    def skipped(self) -> int: ...
    @property
    def empty(self) -> int: ...
    @property
    def components(self) -> int: ...
    @property
    def time_s(self) -> float: ...

def learn(
    robot: Robot,
    database: Database,
    *,
    primitives: Union[PathLike, npt.ArrayLike, None] = None,
    scenes: Optional[Iterable[Union[Scene, Problem]]] = None,
    problems: Optional[Iterable[Problem]] = None,
    paths: int = 5,
    timeout: float = 10.0,
    count: Optional[int] = None,
    seed: int = 1,
    jobs: int = 0,
    on_progress: Optional[Callable[[LearnProgress], object]] = None,
    # settings:learn
    starts_per_link: int = 3,
    paths_per_start: int = 2,
    learn_iterations: int = 20000,
    learn_range: float = 0.4,
    learn_resolution: Optional[float] = None,
    learn_walks: Optional[bool] = None,
    merge_cliques: bool = False,
    # /settings
    kind: Optional[str] = None,
    # settings:memory
    max_gap: Optional[float] = None,
    # /settings
) -> LearnSummary: ...
def learn_from_paths(
    robot: Robot,
    database: Database,
    scene: Scene,
    paths: Iterable[npt.ArrayLike],
    *,
    reach: float = 0.12,
    seed: int = 0,
    kind: Optional[str] = None,
    # settings:memory
    max_gap: Optional[float] = None,
    # /settings
) -> int: ...

class Trajectory:
    @property
    def duration(self) -> float: ...
    @property
    def times(self) -> Floats: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def velocities(self) -> Floats: ...
    @property
    def accelerations(self) -> Floats: ...
    @property
    def stages(self) -> list[dict[str, Any]]: ...
    @property
    def is_of_box(self) -> bool | None: ...
    def to_csv(self) -> str: ...
    def to_yaml(self) -> str: ...
    def to_json(self) -> str: ...

class Plan:
    @property
    def problem(self) -> Problem: ...
    @property
    def status(self) -> str: ...
    @property
    def is_solved(self) -> bool: ...
    @property
    def message(self) -> str: ...
    @property
    def path(self) -> Floats: ...
    @property
    def path_length(self) -> float: ...
    @property
    def primitives(self) -> list[dict[str, Any]]: ...
    @property
    def means(self) -> npt.NDArray[np.float32]: ...
    @property
    def checked_scene(self) -> Scene: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def replayed(self) -> int: ...
    @property
    def replay(self) -> str: ...
    @property
    def remembered(self) -> bool: ...
    @property
    def remember_failure(self) -> str: ...
    @property
    def total_time_s(self) -> float: ...
    @property
    def preparation_time_s(self) -> float: ...
    @property
    def planning_time_s(self) -> float: ...
    @property
    def retrieval_time_s(self) -> float: ...
    @property
    def learning_time_s(self) -> float: ...
    @property
    def simplification_time_s(self) -> float: ...
    @property
    def verification_time_s(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def states_checked(self) -> int: ...
    @property
    def motions_checked(self) -> int: ...
    @property
    def planner(self) -> str: ...
    @property
    def sampler(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def isa(self) -> str: ...
    def trajectory(
        self,
        dt: Optional[float] = None,
        *,
        limits: Optional[PathLike] = None,
        **settings: Any,
    ) -> Trajectory: ...
    def to_json(self) -> str: ...
    def to_svg(self) -> str: ...
    def to_trace(self) -> str: ...
    def to_page(self) -> str: ...
    def to_row(self, set: str = "") -> BenchmarkRow: ...
    def view(self, path: PathLike) -> PathLike: ...
    def _repr_html_(self) -> str: ...

class Busy(Exception):
    retry_after_s: float

class RemotePlan:
    answer: dict[str, Any]
    is_solved: bool
    status: str
    message: str
    path: Floats
    path_length: float
    notes: list[str]
    total_time_s: float
    planning_time_s: float
    retrieval_time_s: float
    learning_time_s: float
    simplification_time_s: float
    verification_time_s: float
    iterations: int
    states_checked: int
    motions_checked: int
    preparation_time_s: float
    remembered: bool
    remember_failure: str
    replayed: int
    replay: str
    planner: str
    sampler: str
    seed: int
    isa: str
    def to_json(self) -> str: ...
    def to_trace(self) -> str: ...

class Client:
    def __init__(
        self,
        url: str = "http://127.0.0.1:7890",
        token: Optional[str] = None,
        timeout_s: float = 120.0,
        patience_s: float = 30.0,
    ) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> Client: ...
    def __exit__(self, *_: object) -> None: ...
    def plan(
        self,
        problem: Optional[Problem] = None,
        *,
        scene: Union[Scene, dict[str, Any], str, None] = None,
        start: Union[npt.ArrayLike, str, dict[str, float], None] = None,
        goals: Union[npt.ArrayLike, PoseGoal, Sequence[Any], None] = None,
        attached: Optional[Sequence[dict[str, Any]]] = None,
        constraints: Optional[Sequence[OrientationConstraint]] = None,
        start_velocity: Optional[npt.ArrayLike] = None,
        end_velocity: Optional[npt.ArrayLike] = None,
        trajectory: Optional[dict[str, Any]] = None,
        trace: bool = False,
        clearance: bool = False,
        remember: bool = True,
        **settings: Any,
    ) -> RemotePlan: ...
    def inverse_kinematics(
        self,
        goals: Union[PoseGoal, Sequence[PoseGoal]],
        *,
        near: Optional[npt.ArrayLike] = None,
        scene: Union[Scene, dict[str, Any], str, None] = None,
        margin: float = 0.0,
        **settings: Any,
    ) -> Solutions: ...
    def check(
        self, configurations: npt.ArrayLike, scene: Union[Scene, dict[str, Any], str, None] = None, margin: float = 0.0
    ) -> list[dict[str, Any]]: ...
    def put_scene(
        self, id: str, scene: Union[Scene, dict[str, Any]], frame: Optional[str] = None
    ) -> list[str]: ...
    def edit_scene(
        self, id: str, remove: Union[str, Sequence[str]] = (), scene: Union[Scene, dict[str, Any], None] = None
    ) -> list[str]: ...
    def delete_scene(self, id: str) -> None: ...
    def health(self) -> dict[str, Any]: ...
    def ask(
        self,
        method: str,
        path: str,
        body: Optional[dict[str, Any]] = None,
        *,
        timeout_s: Optional[float] = None,
    ) -> Any: ...

def plan(
    problem: Problem,
    database: Optional[Database] = None,
    *,
    planner: str = "rrt_connect",
    sampler: Optional[str] = None,
    isa: str = "automatic",
    memory: str = "auto",
    record: bool = False,
    trajectory: Optional[dict[str, Any]] = None,
    # settings:solve
    lambda_: Optional[float] = None,
    least_lambda: Optional[float] = None,
    sigma: Optional[float] = None,
    similarity: Optional[float] = None,
    max_matches: Optional[int] = None,
    mirror: Optional[bool] = None,
    drop_invalid_means: Optional[bool] = None,
    retarget: Optional[bool] = None,
    retrieve_after: Optional[int] = None,
    first_components: Optional[float] = None,
    component_growth: float = 0.5,
    learn_budget: float = 0.0,
    remember_after: Optional[int] = None,
    replay: Optional[float] = None,
    resolution: Optional[float] = None,
    margin: float = 0.0,
    start_tolerance: float = 0.05,
    allow_at_ends: float = 0.005,
    threads: int = 1,
    # /settings
    # settings:plan
    range: Optional[float] = None,
    timeout: float = 10.0,
    max_iterations: Optional[int] = None,
    max_nodes: int = 10000000,
    seed: int = 1,
    simplify: bool = True,
    patience: int = 28,
    minimize_time: Optional[bool] = None,
    improve: float = 0.0,
    improve_rounds: Optional[int] = None,
    verify: bool = True,
    continuous: bool = True,
    neighbours: int = 10,
    goal_bias: float = 0.05,
    anchor: Optional[float] = None,
    anchor_sigma: Optional[float] = None,
    walk: Optional[float] = None,
    walk_after: Optional[int] = None,
    ompl_defaults: bool = False,
    # /settings
    kind: Optional[str] = None,
    # settings:memory
    max_gap: Optional[float] = None,
    # /settings
    # settings:learn
    starts_per_link: int = 3,
    paths_per_start: int = 2,
    learn_iterations: int = 20000,
    learn_range: float = 0.4,
    learn_resolution: Optional[float] = None,
    learn_walks: Optional[bool] = None,
    merge_cliques: bool = False,
    # /settings
    # settings:ik
    ik_seeds: int = 2048,
    ik_solutions: int = 8,
    ik_position_tolerance: float = 0.0001,
    ik_rotation_tolerance: float = 0.001,
    ik_apart: float = 0.1,
    # /settings
) -> Plan: ...

class BenchmarkRow:
    @property
    def problem(self) -> str: ...
    @property
    def set(self) -> str: ...
    @property
    def planner(self) -> str: ...
    @property
    def sampler(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def is_solved(self) -> bool: ...
    @property
    def is_path_valid(self) -> bool: ...
    @property
    def planning_time_s(self) -> float: ...
    @property
    def total_time_s(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def states_checked(self) -> int: ...
    @property
    def path_length(self) -> float: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def components(self) -> int: ...

class Benchmark:
    rows: list[BenchmarkRow]
    def __init__(self, rows: list[BenchmarkRow]) -> None: ...
    def table(self) -> str: ...
    def to_csv(self) -> str: ...
    def __len__(self) -> int: ...
    def _repr_html_(self) -> str: ...

def bench(
    problems: Union[Problem, Iterable[Problem]],
    database: Optional[Database] = None,
    *,
    planners: Union[str, Iterable[str]] = ("rrt_connect",),
    samplers: Union[str, Iterable[str], None] = None,
    seeds: int = 1,
    seed: int = 1,
    csv: Optional[PathLike] = None,
    on_row: Optional[Callable[[BenchmarkRow], object]] = None,
    **settings: Any,
) -> Benchmark: ...
def view(plan: Plan, path: PathLike) -> PathLike: ...

class Plans:
    def __len__(self) -> int: ...
    @property
    def status(self) -> list[str]: ...
    @property
    def messages(self) -> list[str]: ...
    @property
    def is_solved(self) -> npt.NDArray[np.bool_]: ...
    @property
    def seeds(self) -> npt.NDArray[np.uint64]: ...
    @property
    def planning_times_s(self) -> Floats: ...
    @property
    def total_times_s(self) -> Floats: ...
    @property
    def path_offsets(self) -> npt.NDArray[np.int64]: ...
    @property
    def paths(self) -> Floats: ...
    @property
    def trajectory_offsets(self) -> npt.NDArray[np.int64]: ...
    @property
    def times(self) -> Floats: ...
    @property
    def positions(self) -> Floats: ...
    @property
    def velocities(self) -> Floats: ...
    @property
    def accelerations(self) -> Floats: ...
    def columns(self) -> dict[str, npt.NDArray[Any]]: ...

def plan_many(
    problems: Sequence[Problem],
    database: Optional[Database] = None,
    *,
    planner: str = "rrt_connect",
    sampler: Optional[str] = None,
    isa: str = "automatic",
    jobs: int = 0,
    dt: Optional[float] = None,
    **settings: Any,
) -> Plans: ...

class Task:
    def __init__(
        self,
        robot: Robot,
        scene: Scene,
        start: npt.ArrayLike,
        stages: Sequence[dict[str, Any]],
        name: str = "task",
    ) -> None: ...
    @staticmethod
    def load(path: PathLike) -> Task: ...
    @property
    def name(self) -> str: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def stage_count(self) -> int: ...

class TaskPlan:
    @property
    def status(self) -> str: ...
    @property
    def is_solved(self) -> bool: ...
    @property
    def message(self) -> str: ...
    @property
    def stages(self) -> list[dict[str, Any]]: ...
    @property
    def path_time_s(self) -> float: ...
    @property
    def planning_time_s(self) -> float: ...
    @property
    def preparation_time_s(self) -> float: ...
    @property
    def states_checked(self) -> int: ...
    def trajectory(self, dt: Optional[float] = None, limits: Optional[PathLike] = None,
                   **settings: Any) -> Trajectory: ...
    def to_json(self) -> str: ...

def plan_task(
    task: Task,
    database: Optional[Database] = None,
    *,
    planner: str = "rrt_connect",
    sampler: Optional[str] = None,
    isa: str = "automatic",
    **settings: Any,
) -> TaskPlan: ...
