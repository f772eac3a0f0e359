; Chance below a condition.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :parameters (?a - area)
    :precondition (ready)
    :effect (and (when (dirt ?a) (probabilistic 0.7 (not (dirt ?a))))
                 (when (not (dirt ?a)) (probabilistic 0.2 (dirt ?a))))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done)))
