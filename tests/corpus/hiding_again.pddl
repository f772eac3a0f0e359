; Variables that hide others of their name, which hide a parameter; each hidden one is asked of, too.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?p - place) (near ?a ?b - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :parameters (?a - area)
    :precondition (and (ready) (forall (?a - area) (exists (?a - container) (open ?a))))
    :effect (and (when (wet ?a) (done))
                 (forall (?a - area)
                   (when (dirt ?a) (forall (?a - area) (when (wet ?a) (not (dirt ?a)))))))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (dirt a2) (wet a2) (near a1 a2) (ready) (open bin))
  (:goal (done)))
