;  An arm that packs orders: it lines a box, puts things in, closes and labels it.
(define (domain packing)
  (:requirements :strips :typing)
  (:types thing box)
  (:predicates
    (on-shelf ?t - thing)
    (held ?t - thing)
    (gripper-free)
    (empty ?b - box)
    (lined ?b - box)
    (open ?b - box)
    (packed ?t - thing ?b - box)
    (closed ?b - box)
    (labelled ?b - box))

  (:action line
    :parameters (?b - box)
    :precondition (and (empty ?b) (gripper-free))
    :effect (lined ?b))

  (:action grasp
    :parameters (?t - thing)
    :precondition (and (on-shelf ?t) (gripper-free))
    :effect (and (held ?t) (not (on-shelf ?t)) (not (gripper-free))))

  (:action pack
    :parameters (?t - thing ?b - box)
    :precondition (and (held ?t) (open ?b) (lined ?b))
    :effect (and (packed ?t ?b) (gripper-free) (not (held ?t)) (not (empty ?b))))

  (:action close
    :parameters (?b - box)
    :precondition (and (open ?b) (gripper-free))
    :effect (and (closed ?b) (not (open ?b))))

  (:action label
    :parameters (?b - box)
    :precondition (closed ?b)
    :effect (labelled ?b)))
