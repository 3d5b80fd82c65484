; THEOREM    20b: the direction that passes somebody with a clearance.
; ASSUMED    Somebody is at (X, D), as far away as Z > c; w is the tangent's length, and (s, k) the
;            direction of S3.E19 as read: its sine and cosine.
; CONCLUDED  (s, k) is a unit vector, and the line along it is c away from the person exactly.
; SOURCE     own; spec/valley.md, S3.E19.
; TWIN       the distance is taken for the tangent's length.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const X Real)        ; where somebody is, across
(declare-const D Real)        ; and ahead
(declare-const Z Real)        ; how far away
(declare-const c Real)        ; clearance to be kept
(declare-const w Real)        ; length of the tangent
(declare-const s Real)        ; sine of the direction
(declare-const k Real)        ; cosine of the direction
; Assumptions
(assert (= (* Z Z) (+ (* X X) (* D D))))
(assert (> Z c))
(assert (> c 0))
(assert (>= w 0))
(assert (= (* w w) (- (* Z Z) (* c c))))
(assert (= (* s Z Z) (+ (* X w) (* D c))))
(assert (= (* k Z Z) (- (* D w) (* X c))))

; Conclusion, negated
(assert (not (and (= (+ (* s s) (* k k)) 1) (= (- (* D s) (* X k)) c))))
(check-sat)
