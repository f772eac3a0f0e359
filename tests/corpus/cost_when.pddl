; What an action costs depends on a condition.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:functions (total-cost))
  (:action act
    :parameters (?a - area)
    :effect (and (wet ?a) (increase (total-cost) 1) (when (wet ?a) (increase (total-cost) 1/3))
                 (when (dirt ?a) (and (done) (increase (total-cost) 4))))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (near a1 a2) (ready) (open bin))
  (:goal (done))
  (:metric minimize (total-cost)))
