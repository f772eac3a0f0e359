; What is drawn independently of each other.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :parameters (?a - area)
    :precondition (ready)
    :effect (and (probabilistic 0.5 (wet ?a)) (probabilistic 0.25 (not (dirt ?a))) (probabilistic 1/3 (done)))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done)))
