# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of MoveIt as requests to `mneme serve`, and its answers as messages.

Messages are dicts of their fields, as rosidl_runtime_py.message_to_ordereddict makes them; points and quaternions may
be lists, too. What a plan would silently leave out is refused: Unsupported says what.
"""
import math

SHAPES = {1: "box", 2: "sphere", 3: "cylinder"}
# moveit_msgs/MoveItErrorCodes
ERROR_CODES = {"solved": 1, "timeout": -6, "iteration_limit": -1, "node_limit": -1, "cancelled": -7, "invalid_start": -10,
               "invalid_goal": -12}
FAILURE = 99999
NO_IK_SOLUTION = -31
ROTATION_VECTOR_SHARE = 2 / math.pi  # a cone so much narrower has no longer rotation vectors
WIDEST_MIDDLE_ANGLE = 1.4  # radians


class Unsupported(ValueError):
    """A message that says what no request can."""


def xyz(point):
    return [float(point[axis]) for axis in "xyz"] if isinstance(point, dict) else [float(value) for value in point]


def xyzw(quaternion):
    """Of unit length; all zeros, a message that was not filled in, are no rotation."""
    q = ([float(quaternion[axis]) for axis in "xyzw"] if isinstance(quaternion, dict)
         else [float(value) for value in quaternion])
    length = math.sqrt(sum(value * value for value in q))
    return [value / length for value in q] if length > 0 else [0.0, 0.0, 0.0, 1.0]


def product(p, q):
    """Of quaternions x, y, z, w."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return [pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz]


def rotated(q, point):
    turned = product(product(q, [*point, 0.0]), [-q[0], -q[1], -q[2], q[3]])
    return turned[:3]


def pose_of(message):
    """Position and quaternion of a pose; the identity if there is none."""
    if not message:
        return [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
    return xyz(message["position"]), xyzw(message["orientation"])


def chained(outer, inner):
    position = [a + b for a, b in zip(outer[0], rotated(outer[1], inner[0]))]
    return position, product(outer[1], inner[1])


def primitive(message, pose, where):
    kind = message["type"]
    name = SHAPES.get(kind, kind) if isinstance(kind, int) else kind
    sizes = [float(size) for size in message["dimensions"]]
    position, q = pose
    shape = {"type": name, "p": position, "q": [q[3], *q[:3]]}
    if name == "box":
        return {**shape, "size": sizes[:3]}
    if name == "sphere":
        return {"type": name, "p": position, "radius": sizes[0]}
    if name == "cylinder":
        return {**shape, "length": sizes[0], "radius": sizes[1]}
    raise Unsupported(f"{where}: expected boxes, spheres and cylinders, got a primitive of type {kind}")


def mesh(message, pose):
    vertices = [xyz(vertex) for vertex in message["vertices"]]
    corners = [vertices[index] for triangle in message["triangles"] for index in triangle["vertex_indices"]]
    position, q = pose
    return {"type": "mesh", "p": position, "q": [q[3], *q[:3]], "triangles": [x for corner in corners for x in corner]}


def shapes_of(message, where):
    """Of a collision object, in the frame of its header."""
    if message.get("planes"):
        raise Unsupported(f"{where}: planes are not supported")
    base = pose_of(message.get("pose"))
    shapes = [primitive(shape, chained(base, pose_of(pose)), where)
              for shape, pose in zip(message.get("primitives", []), message.get("primitive_poses", []))]
    shapes += [mesh(shape, chained(base, pose_of(pose)))
               for shape, pose in zip(message.get("meshes", []), message.get("mesh_poses", []))]
    if not shapes:
        raise Unsupported(f"{where}: expected a shape, got none")
    return shapes


def obstacles_of(scene):
    """Obstacles, and the frame that all of them share ("" without any)."""
    world = scene.get("world") or {}
    octomap = (world.get("octomap") or {}).get("octomap") or {}
    if octomap.get("data"):
        raise Unsupported("the octomap of the planning scene: send its cells as points to the service instead")
    frames = {(item.get("header") or {}).get("frame_id", "") for item in world.get("collision_objects", [])}
    if len(frames) > 1:
        raise Unsupported(f"expected collision objects in one frame, got {sorted(frames)}")
    obstacles = []
    for item in world.get("collision_objects", []):
        shapes = shapes_of(item, f"collision object '{item['id']}'")
        key = "name" if len(shapes) == 1 else "body"
        obstacles += [{key: item["id"], **shape} for shape in shapes]
    return obstacles, frames.pop() if frames else ""


def attached_of(scene):
    attached = []
    for item in (scene.get("robot_state") or {}).get("attached_collision_objects", []):
        held, link = item["object"], item["link_name"]
        where = f"attached object '{held['id']}'"
        if (held.get("header") or {}).get("frame_id", link) not in ("", link):
            raise Unsupported(f"{where}: expected it in the frame of the link that carries it, {link}")
        attached.append({"name": held["id"], "link": link, "touch": list(item.get("touch_links", [])),
                         "shapes": shapes_of(held, where)})
    return attached


def allowed_of(scene, obstacles, attached):
    """Pairs that may touch, of which one is no link: the service's SRDF has those of two links."""
    matrix = scene.get("allowed_collision_matrix") or {}
    names = matrix.get("entry_names", [])
    world = {shape.get("name", shape.get("body")) for shape in obstacles}
    objects = world | {item["name"] for item in attached}
    defaults = zip(matrix.get("default_entry_names", []), matrix.get("default_entry_values", []))
    for name, is_allowed in defaults:
        if is_allowed and name in objects:
            raise Unsupported(f"'{name}' may touch everything: expected pairs in the allowed_collision_matrix")
    pairs = []
    for i, (first, entry) in enumerate(zip(names, matrix.get("entry_values", []))):
        row = entry["enabled"] if isinstance(entry, dict) else entry
        pairs += [[first, second] for second, is_allowed in list(zip(names, row))[i + 1:]
                  if is_allowed and {first, second} & objects and not {first, second} <= world]
    return pairs


def start_of(request, scene, joints):
    """The scene's state, with what the request's says instead."""
    values = {}
    for state in (scene.get("robot_state"), request.get("start_state")):
        state = (state or {}).get("joint_state") or {}
        values.update(zip(state.get("name", []), state.get("position", [])))
    missing = [name for name in joints if name not in values]
    if missing:
        raise Unsupported(f"expected a start of each joint that is planned for, got none of {', '.join(missing)}")
    return [float(values[name]) for name in joints]


def joint_goal(goal, joints):
    values = {constraint["joint_name"]: constraint["position"] + 0.5 * (constraint.get("tolerance_above", 0)
                                                                        - constraint.get("tolerance_below", 0))
              for constraint in goal["joint_constraints"]}
    missing = [name for name in joints if name not in values]
    if missing:
        raise Unsupported(f"expected a goal of each joint that is planned for, got none of {', '.join(missing)}")
    return [float(values[name]) for name in joints]


def only(goal, key):
    constraints = goal.get(key) or []
    if len(constraints) > 1:
        raise Unsupported(f"expected at most one of {key} in a goal, got {len(constraints)}")
    return constraints[0] if constraints else None


def orientation_keys(constraint):
    widest = max(range(3), key=lambda i: float(constraint.get(f"absolute_{'xyz'[i]}_axis_tolerance", 0)))
    tolerances = [min(float(constraint.get(f"absolute_{axis}_axis_tolerance", 0)), math.pi) for axis in "xyz"]
    turn = tolerances.pop(widest)
    cone = min(tolerances)
    if constraint.get("parameterization", 0) == 1:
        cone *= ROTATION_VECTOR_SHARE
    elif widest == 1:
        # The middle Euler angle enlarges the lean in the two others, and flips them beyond a quarter turn.
        turn = min(turn, WIDEST_MIDDLE_ANGLE)
        cone = math.atan(math.tan(min(cone, WIDEST_MIDDLE_ANGLE)) * math.cos(turn))
    # Leaning turns the angles about the axis, too, a little.
    turn = "free" if turn >= math.pi else max(0.0, turn - cone * cone / 2)
    return {"quat_xyzw": xyzw(constraint["orientation"]), "axis": "xyz"[widest], "cone": cone, "turn": turn}


def position_keys(constraint):
    """The cube inside of the ball that is the region; other regions have other axes than the goal."""
    region = constraint["constraint_region"]
    if any(xyz(constraint.get("target_point_offset") or [0, 0, 0])):
        raise Unsupported("expected no target_point_offset: the link's origin is what is placed")
    solids, poses = region.get("primitives", []), region.get("primitive_poses", [])
    is_ball = len(solids) == 1 and len(poses) == 1 and solids[0]["type"] in (2, "sphere") and not region.get("meshes")
    if not is_ball:
        raise Unsupported("expected a constraint_region that is one sphere")
    return {"position": pose_of(poses[0])[0], "position_tolerance": float(solids[0]["dimensions"][0]) / math.sqrt(3)}


def pose_goal(goal):
    position, orientation = only(goal, "position_constraints"), only(goal, "orientation_constraints")
    if position is None:
        raise Unsupported("expected a position_constraint beside the orientation_constraint, got none")
    if goal.get("joint_constraints"):
        raise Unsupported("expected joint_constraints alone, or constraints of position and orientation")
    pose = {"link": position["link_name"], **position_keys(position)}
    frames = [(position.get("header") or {}).get("frame_id", "")]
    if orientation is not None:
        if orientation["link_name"] != pose["link"]:
            raise Unsupported(f"expected the link of the position_constraint, {pose['link']}, in the other one, too")
        pose.update(orientation_keys(orientation))
        frames.append((orientation.get("header") or {}).get("frame_id", ""))
    if len(set(frames)) > 1:
        raise Unsupported(f"expected the constraints of a goal in one frame, got {frames}")
    return {**pose, "frame": frames[0]} if frames[0] else pose


def goal_of(goal, joints):
    if goal.get("visibility_constraints"):
        raise Unsupported("visibility_constraints are not supported")
    is_pose = goal.get("position_constraints") or goal.get("orientation_constraints")
    return pose_goal(goal) if is_pose else joint_goal(goal, joints)


def refuse_what_no_request_says(request, scene):
    for key in ("path_constraints", "trajectory_constraints"):
        if any(value for name, value in (request.get(key) or {}).items() if name != "name"):
            raise Unsupported(f"{key} are not supported")
    for padding in scene.get("link_padding") or []:
        if padding.get("padding"):
            raise Unsupported(f"link_padding of {padding.get('link_name')}: give the service's setting 'margin' instead")
    for scale in scene.get("link_scale") or []:
        if scale.get("scale", 1) != 1:
            raise Unsupported(f"link_scale of {scale.get('link_name')} is not supported")


def to_plan_request(request, scene, joints, links=None):
    """The body of POST /v1/plan for a MotionPlanRequest in a PlanningScene.

    joints: those that the service plans for (GET /healthz). links: of frames that the robot does not have, the link
    that stands for them, such as {"world": "base_link"}.
    """
    refuse_what_no_request_says(request, scene)
    stands_for = dict(links or {})
    obstacles, frame = obstacles_of(scene)
    attached = attached_of(scene)
    body = {"joints": list(joints), "start": start_of(request, scene, joints), "obstacles": obstacles,
            "goals": [goal_of(goal, joints) for goal in request["goal_constraints"]]}
    if frame:
        body["frame"] = stands_for.get(frame, frame)
    for goal in body["goals"]:
        if isinstance(goal, dict) and "frame" in goal:
            goal["frame"] = stands_for.get(goal["frame"], goal["frame"])
    if attached:
        body["attached"] = attached
    allowed = allowed_of(scene, obstacles, attached)
    if allowed:
        body["allow"] = allowed
    if request.get("allowed_planning_time"):
        body["settings"] = {"timeout": float(request["allowed_planning_time"])}
    return body


def to_plan_response(answer, joints, group):
    """The fields of a MotionPlanResponse. The path has no times: MoveIt's time parameterization gives it some."""
    points = [{"positions": q} for q in answer["path"]]
    return {"group_name": group, "planning_time": answer["total_time_s"],
            "trajectory": {"joint_trajectory": {"joint_names": list(joints), "points": points}},
            "error_code": {"val": ERROR_CODES.get(answer["status"], FAILURE)}}


def to_ik_request(request, scene, joints, links=None):
    """The body of POST /v1/ik for a PositionIKRequest in a PlanningScene. The search begins at the request's state.

    Obstacles are left out unless avoid_collisions is set; the robot never touches itself.
    """
    if any(value for name, value in (request.get("constraints") or {}).items() if name != "name"):
        raise Unsupported("constraints of inverse kinematics are not supported")
    if request.get("pose_stamped_vector"):
        raise Unsupported("expected pose_stamped, the pose of one link, got pose_stamped_vector")
    link = request.get("ik_link_name")
    if not link:
        raise Unsupported("expected ik_link_name, the link that pose_stamped is for")
    stands_for = dict(links or {})
    stamped = request["pose_stamped"]
    position, q = pose_of(stamped.get("pose"))
    goal = {"link": link, "position": position, "quat_xyzw": q}
    frame = (stamped.get("header") or {}).get("frame_id", "")
    if frame:
        goal["frame"] = stands_for.get(frame, frame)
    attached = attached_of(scene)
    body = {"joints": list(joints), "goal": goal, "obstacles": [],
            "near": start_of({"start_state": request.get("robot_state")}, scene, joints)}
    if request.get("avoid_collisions"):
        refuse_what_no_request_says({}, scene)
        obstacles, frame = obstacles_of(scene)
        body["obstacles"] = obstacles
        if frame:
            body["frame"] = stands_for.get(frame, frame)
        allowed = allowed_of(scene, obstacles, attached)
        if allowed:
            body["allow"] = allowed
    if attached:
        body["attached"] = attached
    return body


def to_ik_response(answer, joints):
    """The fields of a response of GetPositionIK: the solution nearest to the start."""
    if not answer["solutions"]:
        return {"error_code": {"val": NO_IK_SOLUTION}}
    nearest = min(answer["solutions"], key=lambda solution: solution["distance"])
    return {"solution": {"joint_state": {"name": list(joints), "position": nearest["q"]}}, "error_code": {"val": 1}}
