; Areas of a table that are to be clean. A push may spill what is wet.
(define (domain tidy)
  (:requirements :adl :probabilistic-effects :fluents)
  (:types area container - place)
  (:constants bin - container)
  (:predicates (dirt ?a - area) (wet ?a - area) (next-to ?a ?b - area) (full ?c - container) (colour ?a - area))
  (:functions (total-cost))

  (:action push
    :parameters (?a - area)
    :precondition (and (dirt ?a) (or (not (wet ?a)) (not (full bin))))
    :effect (and (increase (total-cost) 2)
                 (probabilistic 0.8 (not (dirt ?a)))
                 (when (wet ?a)
                   (probabilistic 0.1 (forall (?m - area) (when (next-to ?a ?m) (wet ?m)))))))

  (:action move
    :parameters (?from ?to - area)
    :precondition (dirt ?from)
    :effect (and (increase (total-cost) 1) (not (dirt ?from)) (dirt ?to)))

  (:action empty-bin
    :effect (and (increase (total-cost) 5) (not (full bin)))))
