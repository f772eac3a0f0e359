; Chance inside of chance.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :parameters (?a - area)
    :precondition (ready)
    :effect (probabilistic 0.5 (and (wet ?a) (probabilistic 0.4 (dirt ?a) 0.6 (not (dirt ?a))))
                           0.25 (probabilistic 0.5 (done)))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done)))
