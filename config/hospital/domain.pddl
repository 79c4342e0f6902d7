; A courier of a hospital at night: it brings things from the basement to whoever asks for them,
; by one of two lifts, and goes back to its dock.
(define (domain hospital)
  (:requirements :strips :typing)
  (:types ward - spot spot lift cargo)
  (:predicates
    (robot-at ?s - spot)
    (corridor ?a ?b - spot)
    (stops-at ?l - lift ?s - spot)
    (running ?l - lift)
    (waits ?c - cargo ?s - spot)
    (loaded ?c - cargo)
    (brought ?c - cargo ?s - spot)
    (dock ?s - spot)
    (docked))

  (:action drive
    :parameters (?a ?b - spot)
    :precondition (and (robot-at ?a) (corridor ?a ?b))
    :effect (and (not (robot-at ?a)) (robot-at ?b)))

  (:action take-lift
    :parameters (?l - lift ?a ?b - spot)
    :precondition (and (robot-at ?a) (stops-at ?l ?a) (stops-at ?l ?b) (running ?l))
    :effect (and (not (robot-at ?a)) (robot-at ?b)))

  (:action pick-up
    :parameters (?c - cargo ?s - spot)
    :precondition (and (robot-at ?s) (waits ?c ?s))
    :effect (and (not (waits ?c ?s)) (loaded ?c)))

  (:action bring
    :parameters (?c - cargo ?s - spot)
    :precondition (and (robot-at ?s) (loaded ?c))
    :effect (and (not (loaded ?c)) (brought ?c ?s)))

  (:action return
    :parameters (?s - spot)
    :precondition (and (robot-at ?s) (dock ?s))
    :effect (docked)))
