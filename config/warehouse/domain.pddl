; A warehouse floor: a robot fetches objects from two rooms and leaves by a door.
; After the user study of Persiani and Hellström, "Informative Communication of Robot Plans".
(define (domain warehouse)
  (:requirements :strips :typing)
  (:types place item door)

  (:predicates
    (robot-at ?p - place)
    (connected ?a ?b - place)
    (item-at ?i - item ?r - place)
    (holding ?i - item)
    (door-at ?d - door ?p - place)
    (station-at ?p - place)
    (charged)
    (outside ?d - door))

  (:action move
    :parameters (?a ?b - place)
    :precondition (and (robot-at ?a) (connected ?a ?b))
    :effect (and (not (robot-at ?a)) (robot-at ?b)))

  (:action grab
    :parameters (?i - item ?r - place)
    :precondition (and (robot-at ?r) (item-at ?i ?r))
    :effect (and (not (item-at ?i ?r)) (holding ?i)))

  (:action recharge
    :parameters (?p - place)
    :precondition (and (robot-at ?p) (station-at ?p))
    :effect (charged))

  ; The robot may leave the floor only with a charged battery.
  (:action exit
    :parameters (?d - door ?p - place)
    :precondition (and (robot-at ?p) (door-at ?d ?p) (charged))
    :effect (and (not (robot-at ?p)) (outside ?d))))
