; Variables called by words of the language of .nid files.
(define (domain corpus)
  (:requirements :adl :probabilistic-effects)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?rest - area) (wet ?if - place) (near ?not ?count - area) (in ?a - area ?c - container)
               (open ?c - container) (ready) (done))
  (:action act
    :parameters (?count - area)
    :precondition (exists (?with - area) (near ?count ?with))
    :effect (and (probabilistic 0.5 (done))
                 (forall (?rest - area) (when (dirt ?rest) (not (wet ?rest)))))))

(define (problem start)
  (:domain corpus)
  (:objects a1 a2 - area box - container)
  (:init (dirt a1) (wet a1) (near a1 a2) (ready) (open bin))
  (:goal (done)))
