"""Files beside TRC with which OpenSim places the markers, scales a model and finds its angles.

The markers are joint centres, and in OpenSim's full-body model (Rajagopal et al. 2016) the origin
of a segment is the joint at its upper end, so every marker of a limb has the place 0, 0, 0. Nose,
eyes and ears have no segment in that model and are left out.
"""

from pathlib import Path
from xml.etree import ElementTree as Xml

from trecsim.export.motions import PersonMotion

_SEGMENTS = {
    "Shoulder": "humerus", "Elbow": "ulna", "Wrist": "hand", "Hip": "femur", "Knee": "tibia",
    "Ankle": "talus",
}  # fmt: skip
_MEASURES = {
    "thigh": ("Hip", "Knee", ("femur",)),
    "shank": ("Knee", "Ankle", ("tibia",)),
    "upper_arm": ("Shoulder", "Elbow", ("humerus",)),
    "forearm": ("Elbow", "Wrist", ("ulna", "radius")),
}
_SIDES = (("R", "r"), ("L", "l"))
_VERSION = "40000"


def setup_files(out: Path, people: list[tuple[PersonMotion, Path]]) -> dict[Path, str]:
    """Return the files by name: one marker set, and per person a scaling and an IK setup.

    Parameters
    ----------
    out
        The TRC file that was asked for; its name is the beginning of theirs.
    people
        Each person with the TRC file that it is written to.
    """
    markers = out.with_name(f"{out.stem}_markers.xml")
    files = {markers: _text(_marker_set(markers.stem))}
    for one, trc in people:
        span = (float(one.t_s[0]), float(one.t_s[-1]))
        scaling = trc.with_name(f"{trc.stem}_scaling.xml")
        files[scaling] = _text(_scaling(trc, markers.name, span))
        kinematics = trc.with_name(f"{trc.stem}_ik.xml")
        files[kinematics] = _text(_inverse_kinematics(trc, span))
    return files


def _text(root: Xml.Element) -> str:
    document = Xml.Element("OpenSimDocument", Version=_VERSION)
    document.append(root)
    Xml.indent(document, "\t")
    return Xml.tostring(document, "unicode", xml_declaration=True) + "\n"


def _add(parent: Xml.Element, tag: str, text: str = "", **attributes: str) -> Xml.Element:
    child = Xml.SubElement(parent, tag, attributes)
    child.text = text or None
    return child


def _names() -> list[tuple[str, str]]:
    """Return each marker with the segment it is on."""
    return [
        (f"{side}{joint}", f"{segment}_{letter}")
        for side, letter in _SIDES
        for joint, segment in _SEGMENTS.items()
    ]


def _marker_set(name: str) -> Xml.Element:
    root = Xml.Element("MarkerSet", name=name)
    objects = _add(root, "objects")
    for marker, segment in _names():
        one = _add(objects, "Marker", name=marker)
        _add(one, "socket_parent_frame", f"/bodyset/{segment}")
        _add(one, "location", "0 0 0")
        _add(one, "fixed", "true")
    return root


def _scaling(trc: Path, markers: str, span: tuple[float, float]) -> Xml.Element:
    root = Xml.Element("ScaleTool", name=trc.stem)
    _add(root, "mass", "-1")
    _add(root, "height", "-1")
    maker = _add(root, "GenericModelMaker")
    _add(maker, "model_file", "Rajagopal2016.osim")
    _add(maker, "marker_set_file", markers)
    scaler = _add(root, "ModelScaler")
    _add(scaler, "apply", "true")
    _add(scaler, "scaling_order", "measurements")
    objects = _add(_add(scaler, "MeasurementSet"), "objects")
    for name, (start, end, segments) in _MEASURES.items():
        pairs = [(f"{side}{start}", f"{side}{end}") for side, _ in _SIDES]
        bodies = [f"{segment}_{letter}" for segment in segments for _, letter in _SIDES]
        _measure(objects, name, pairs, bodies, "X Y Z")
    sides = [(f"{side}Hip", f"{side}Shoulder") for side, _ in _SIDES]
    _measure(objects, "trunk", sides, ["torso"], "X Y Z")
    _measure(objects, "pelvis", [("RHip", "LHip")], ["pelvis"], "X Y Z")
    _add(scaler, "marker_file", trc.name)
    _add(scaler, "time_range", f"{span[0]:.6f} {span[1]:.6f}")
    _add(scaler, "preserve_mass_distribution", "false")
    _add(scaler, "output_model_file", f"{trc.stem}_scaled.osim")
    placer = _add(root, "MarkerPlacer")
    _add(placer, "apply", "false")
    return root


def _measure(
    objects: Xml.Element, name: str, pairs: list[tuple[str, str]], bodies: list[str], axes: str
) -> None:
    one = _add(objects, "Measurement", name=name)
    _add(one, "apply", "true")
    listed = _add(_add(one, "MarkerPairSet"), "objects")
    for a, b in pairs:
        _add(_add(listed, "MarkerPair"), "markers", f"{a} {b}")
    scales = _add(_add(one, "BodyScaleSet"), "objects")
    for body in bodies:
        _add(_add(scales, "BodyScale", name=body), "axes", axes)


def _inverse_kinematics(trc: Path, span: tuple[float, float]) -> Xml.Element:
    root = Xml.Element("InverseKinematicsTool", name=trc.stem)
    _add(root, "model_file", f"{trc.stem}_scaled.osim")
    _add(root, "marker_file", trc.name)
    _add(root, "time_range", f"{span[0]:.6f} {span[1]:.6f}")
    _add(root, "output_motion_file", f"{trc.stem}_ik.mot")
    objects = _add(_add(root, "IKTaskSet"), "objects")
    for marker, _ in _names():
        task = _add(objects, "IKMarkerTask", name=marker)
        _add(task, "apply", "true")
        _add(task, "weight", "1")
    return root
