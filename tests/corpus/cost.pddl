; What an action costs, whatever comes of it.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:functions (total-cost))
  (:action act
    :parameters (?a - area)
    :precondition (dirt ?a)
    :effect (and (increase (total-cost) 2.5) (probabilistic 0.4 (done)))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done))
  (:metric minimize (total-cost)))
