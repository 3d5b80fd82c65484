; THEOREM    01c: pieces of braking add up.
; ASSUMED    Two pieces of braking, from v to v1 and from v1 to v2, each bounded as in 01b.
; CONCLUDED  Both together are bounded in the same way; so by induction are any number of pieces,
;            and in the limit any course of braking at b or harder.
; SOURCE     own.
; TWIN       the robot speeds up between the pieces.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed after the first piece
(declare-const v2 Real)       ; speed after the second
(declare-const t Real)        ; time of the first
(declare-const x Real)        ; way of the first
(declare-const t2 Real)       ; time of the second
(declare-const x2 Real)       ; way of the second
(declare-const vm Real)       ; speed at which the second begins
; Assumptions
(assert (> b 0))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= v2 0))
(assert (>= vm 0))
(assert (= vm v1))
(assert (<= (* b t) (- v v1)))
(assert (<= (* 2 b x) (- (* v v) (* v1 v1))))
(assert (<= (* b t2) (- vm v2)))
(assert (<= (* 2 b x2) (- (* vm vm) (* v2 v2))))

; Conclusion, negated
(assert (not (and (<= (* b (+ t t2)) (- v v2)) (<= (* 2 b (+ x x2)) (- (* v v) (* v2 v2))))))
(check-sat)
