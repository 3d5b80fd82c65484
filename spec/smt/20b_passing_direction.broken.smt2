; BROKEN     Twin of 20b_passing_direction.smt2: the distance is taken for the tangent's length.
(set-info :status sat)
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
(assert (= (* w w) (* Z Z)))                           ; BROKEN: no tangent
(assert (= (* s Z Z) (+ (* X w) (* D c))))
(assert (= (* k Z Z) (- (* D w) (* X c))))

; Conclusion, negated
(assert (not (and (= (+ (* s s) (* k k)) 1) (= (- (* D s) (* X k)) c))))
(check-sat)
