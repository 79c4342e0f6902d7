; Enough for a robot that has no PDDL: it has tasks, and each is done at some time.
(define (domain tasks) (:requirements :strips :typing)
  (:types task) (:predicates (done ?task - task))
  (:action do :parameters (?task - task) :effect (done ?task)))
