; Chance for each object by itself.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :precondition (ready)
    :effect (forall (?m - area) (when (dirt ?m) (probabilistic 0.5 (not (dirt ?m)))))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done)))
