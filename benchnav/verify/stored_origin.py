"""How a stored episode was made, so that its navigator can be run again."""

from benchnav.episode.episode import Identity
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.untrusted_spec import is_by_module, is_program


def stored_origin(run: RunFolder, identity: Identity) -> Assignment | str:
    """Return the assignment of an episode, or why its navigator must not be run again.

    A pack may come from a stranger: only registered navigators are used for it.
    """
    label = identity.navigator
    fields = next(each for each in run.manifest.suite["navigators"] if each["label"] == label)
    spec = fields["config"]
    if run.packed is not None and (is_program(spec) or is_by_module(spec)):
        return "it is a program or is named by its module, and packs are not trusted"
    return Assignment(
        identity.scenario, identity.scenario_hash, identity.split, identity.track, label,
        dict(spec), salt=run.manifest.salt, rehearsals=int(fields.get("rehearsal", 0)),
    )  # fmt: skip
