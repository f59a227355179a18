from dataclasses import replace

import numpy as np
from benchnav_baselines.controllers.orca.controller import OrcaController
from benchnav_baselines.controllers.path_following import PathFollowing

from benchnav.navigation.controller import Guide
from tests.baselines.crowds import DT, briefing, joined, one_world


def guide_to(target):
    at = target.shape[:2]
    return Guide(target, np.full(at, 3.0), np.ones(at, bool))


def steer(controller, told, seen, target):
    controller.reset(told, seen.rows)
    return controller.steer(seen, guide_to(target))


def test_it_goes_to_the_guides_target_at_preferred_speed_and_not_past_it():
    told = briefing([(0, 0), (1, 1)], [(9, 9), (9, 9)], preferred=0.5)
    _, seen = one_world(0, 2)
    seen = replace(seen, position=told.start[None], goal=told.goal[None])
    target = np.array([[(0.0, 2.0), (1.05, 1.0)]])
    command = steer(PathFollowing(), [told], seen, target)
    np.testing.assert_allclose(command, [[(0.0, 0.5), (0.05 / DT, 0.0)]])


def test_orca_avoids_on_its_way_to_the_target():
    told, seen = one_world(0, 6)
    target = seen.position + np.array([0.0, 3.0])
    controller = OrcaController(OrcaController.Config(perturbation=0))
    free = replace(seen, neighbours=None, edges=None)
    np.testing.assert_allclose(steer(controller, [told], free, target), [[(0.0, 1.0)] * 6])
    assert np.abs(steer(controller, [told], seen, target) - (0.0, 1.0)).max() > 0.1


def test_batch_does_not_matter():
    worlds = [one_world(w, 4) for w in range(3)]
    told, seen = zip(*worlds, strict=True)
    target = np.random.default_rng(1).normal(0, 3, (3, 4, 2))
    for make in (PathFollowing, lambda: OrcaController(OrcaController.Config(perturbation=0))):
        together = steer(make(), told, joined(seen), target)
        for w in range(3):
            alone = steer(make(), [told[w]], seen[w], target[w : w + 1])
            np.testing.assert_array_equal(alone[0], together[w])
