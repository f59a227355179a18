"""Worlds as JSON: people, whom worlds of earlier versions do not have."""

from dataclasses import replace

from benchnav.generation.world_digest import world_digest
from benchnav.store.parts.world_codec import world_from_json, world_to_json
from benchnav.testing.zoo import zoo


def test_only_the_bodies_of_people_are_marked():
    drawn = zoo()["smooth"].world
    plain, text = drawn.bodies[0], world_to_json(drawn)
    assert b"person" not in text
    people = replace(drawn, bodies=(plain, replace(plain, person=True), plain))
    again = world_from_json(world_to_json(people).decode())
    assert [body.person for body in again.bodies] == [False, True, False]
    assert world_digest(again) == world_digest(people)
    assert world_digest(again) != world_digest(replace(drawn, bodies=(plain, plain, plain)))
    assert world_digest(world_from_json(text.decode())) == world_digest(drawn)
