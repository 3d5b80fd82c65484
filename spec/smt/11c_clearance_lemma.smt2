; THEOREM    11c: the geometric lemma: how near robot and thing can have come.
; ASSUMED    The thing was seen at a distance P >= R + d, and the x axis is laid through it, so n
;            = (1, 0); the centre has moved by q with n q <= kappa l (11a), the thing by m of
;            length V t at most.
; CONCLUDED  The distance of thing and centre is P - kappa l - V t at least, so the clearance of
;            the hull is d - kappa l - V t at least.
; SOURCE     own; the d of Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, Theorem 2 is
;            measured per axis, this one in any direction.
; TWIN       the thing's own way is forgotten.
; SOLVERS    z3
(set-info :status unsat)
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
(assert (not (>= (- D R) (- d (* kappa l) (* V t)))))
(check-sat)
