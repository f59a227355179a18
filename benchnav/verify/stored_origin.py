"""How a stored episode was made, so that its navigator can be run again."""

from benchnav.arena.noise import Noise
from benchnav.episode.episode import Episode, Identity
from benchnav.generation.build import noise_of
from benchnav.runner.rollouts.rehearsal import stored_grant
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.scenario.condition import NOISY
from benchnav.scenario.scenario import Scenario
from benchnav.store.parts.part import Part
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.own_map import Production
from benchnav.verify.untrusted_spec import is_by_module, is_program


def stored_origin(run: RunFolder, part: Part, episode: Episode) -> Production | str:
    """Return how an episode of ``part`` was made, or why its navigator must not be run again.

    A pack may come from a stranger: only registered navigators are used for it.
    """
    identity = episode.identity
    label = identity.navigator
    named = [each for each in run.manifest.suite["navigators"] if each["label"] == label]
    if not named:
        return "no navigator is evaluated in an undisturbed world"
    fields = named[0]
    spec = fields["config"]
    if run.packed is not None and (is_program(spec) or is_by_module(spec)):
        return "it is a program or is named by its module, and packs are not trusted"
    assignment = Assignment(
        identity.scenario, identity.scenario_hash, identity.split, identity.track, label,
        dict(spec), salt=run.manifest.salt, rehearsals=int(fields.get("rehearsal", 0)),
        noise=_noise(run, identity),
    )  # fmt: skip
    if not assignment.rehearsals:
        return Production(assignment)
    stored = [each for each in part.rehearsals() if each.identity.seed == identity.seed]
    stored.sort(key=lambda each: each.identity.rehearsal)
    return Production(assignment, stored_grant(episode.world, stored))


def _noise(run: RunFolder, identity: Identity) -> Noise | None:
    """Return the noise of the stored scenario; None for exact perception."""
    if identity.perception != NOISY:
        return None
    scenarios = run.manifest.suite["scenarios"]
    fields = next(each for each in scenarios if each["scenario"] == identity.scenario)
    return noise_of(Scenario.model_validate(fields["config"]))
