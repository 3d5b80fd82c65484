; BROKEN     Twin of 11c_clearance_lemma.smt2: the thing's own way is forgotten.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const R Real)        ; radius of the hull
(declare-const d Real)        ; clearance when seen
(declare-const P Real)        ; distance when seen
(declare-const kappa Real)    ; closing cosine
(declare-const l Real)        ; length of the robot's way
(declare-const qx Real)       ; the robot's way
(declare-const qy Real)
(declare-const V Real)        ; greatest speed of the thing
(declare-const t Real)        ; time since it was seen
(declare-const mx Real)       ; the thing's way
(declare-const my Real)
(declare-const D Real)        ; distance now
; Assumptions
(assert (>= R 0))
(assert (<= 0 kappa 1))
(assert (>= l 0))
(assert (>= V 0))
(assert (>= t 0))
(assert (>= P (+ R d)))
(assert (<= qx (* kappa l)))
(assert (<= (+ (* qx qx) (* qy qy)) (* l l)))
(assert (<= (+ (* mx mx) (* my my)) (* V t V t)))
(assert (>= D 0))
(assert (= (* D D) (+ (* (+ (- P qx) mx) (+ (- P qx) mx)) (* (- my qy) (- my qy)))))

; Conclusion, negated
(assert (not (>= (- D R) (- d (* kappa l)))))                ; BROKEN: V t is missing
(check-sat)
